use super::*;
use crate::access::Level;
use std::time::Duration;

fn changed() -> (Look, Access) {
    let look = Look {
        language: Language::Chinese,
        high_contrast: true,
        left_handed: true,
        keys_on_screen: true,
        zoom: 1.35,
    };
    let mut access = Access::default();
    access.set_pin(Level::Engineer, Some("1234")).unwrap();
    (look, access)
}

/// Written into a new folder; the file.
fn written(folder: &Path) -> PathBuf {
    let file = folder.join("not there yet").join("hmi.toml");
    let settings = Settings::read(file.clone());
    assert_eq!(settings.unread, None);
    assert_eq!(settings.look, Look::default());
    assert!(!settings.access.is_restricted());
    let (look, access) = changed();
    settings.write(&look, access.pins()).unwrap();
    file
}

#[test]
fn what_is_written_is_read_again_and_only_by_its_owner() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path());
    let mut read = Settings::read(file.clone());
    assert_eq!((read.unread.take(), &read.look), (None, &changed().0));
    assert_eq!(read.access.level(), Level::Operator);
    assert_eq!(read.access.enter("1234", Duration::ZERO), Ok(Level::Engineer));
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        assert_eq!(file.metadata().unwrap().permissions().mode() & 0o777, 0o600);
    }
    let text = std::fs::read_to_string(&file).unwrap();
    assert!(
        text.contains("size = 1.35\n") && !text.contains("1234\""),
        "{text}"
    );
    read.write(&Look::default(), None).unwrap();
    assert!(!Settings::read(file).access.is_restricted());
}

#[test]
fn a_broken_file_is_told_with_its_line_and_never_written_over() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("hmi.toml");
    for (text, line, said) in [
        ("language = \"en\"\nsize = \"big\"\n", "line 2", "size"),
        ("size = 9.0\n", "line 1", "must be from 0.75 to 2.5"),
        ("size = 1.0\nhand = 1\n", "line 2", "hand"),
        ("\n\nlanguage = \"xx\"\n", "line 3", "language"),
    ] {
        std::fs::write(&file, text).unwrap();
        let read = Settings::read(file.clone());
        let unread = read.unread.clone().expect("told");
        for part in ["hmi.toml", line, said] {
            assert!(unread.contains(part), "{part}: {unread}");
        }
        assert_eq!(read.look, Look::default());
        assert!(!read.access.is_restricted());
        read.write(&changed().0, None).unwrap();
        assert_eq!(std::fs::read_to_string(&file).unwrap(), text);
    }
}

#[test]
fn where_pins_may_be_in_it_a_broken_file_lets_nobody_in() {
    let folder = tempfile::tempdir().unwrap();
    let file = written(folder.path());
    let whole = std::fs::read_to_string(&file).unwrap();
    let cut_off = &whole[..whole.len() - 20];
    let no_pin = whole.replace("sha256:", "sha257:");
    for text in [cut_off, &no_pin, &format!("{whole}x")] {
        std::fs::write(&file, text).unwrap();
        let read = Settings::read(file.clone());
        assert!(read.unread.is_some(), "{text}");
        assert!(!read.access.allows(Level::Setter), "{text}");
    }
    // Nobody knows what is in it.
    std::fs::write(&file, b"\xff\xfe").unwrap();
    assert!(!Settings::read(file.clone()).access.allows(Level::Setter));
    assert!(
        !Settings::read(folder.path().to_owned())
            .access
            .allows(Level::Setter)
    );
}

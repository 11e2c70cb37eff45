//! Pictures in PNG files.

use crate::Picture;
use ::png::{BitDepth, ColorType, Compression, Decoder, DecodingError, Encoder, EncodingError};
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Seek};
use std::path::Path;
use thiserror::Error;
use vision::MOST_PIXELS;

/// Why a file gives no picture, or takes none. Reads as one sentence.
#[derive(Debug, Error)]
pub enum PngError {
    /// The file cannot be read.
    #[error("cannot read picture {file}: {source}")]
    Read {
        /// The file.
        file: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// It is no PNG file, or only a part of one.
    #[error("picture {file} is not a PNG file, or is damaged: {source}")]
    Broken {
        /// The file.
        file: String,
        /// What is wrong.
        source: DecodingError,
    },
    /// Its pixels are not what cameras give.
    #[error("picture {file} has {kind}; only grey pictures of 8 bits a pixel can be measured: convert it")]
    Kind {
        /// The file.
        file: String,
        /// What its pixels are.
        kind: String,
    },
    /// It says that it is larger than any camera's.
    #[error(
        "picture {file} has {columns} × {rows} pixels; at most {} million in all can be read: crop it",
        MOST_PIXELS / 1_000_000
    )]
    TooLarge {
        /// The file.
        file: String,
        /// Its width.
        columns: u32,
        /// Its height.
        rows: u32,
    },
    /// The file cannot be written.
    #[error("cannot write picture {file}: {source}")]
    Write {
        /// The file.
        file: String,
        /// What the system said.
        source: EncodingError,
    },
}

/// Reads a grey picture of 8 bits a pixel into `picture`, whose capture and time stay as they are.
/// After an error its pixels mean nothing.
///
/// Other pictures are refused: a picture that was made darker, lighter or coarser measures something else.
pub fn read_grey(path: &Path, picture: &mut Picture) -> Result<(), PngError> {
    let name = path.display().to_string();
    match File::open(path) {
        Ok(file) => parse_grey(&name, BufReader::new(file), picture),
        Err(source) => Err(PngError::Read { file: name, source }),
    }
}

/// Understands a grey picture as [`read_grey`] does; `name` of the file is used in messages only.
pub fn parse_grey(name: &str, bytes: impl BufRead + Seek, picture: &mut Picture) -> Result<(), PngError> {
    let file = || name.to_owned();
    let broken = |source| PngError::Broken { file: file(), source };
    let mut reader = Decoder::new(bytes).read_info().map_err(broken)?;
    let info = reader.info();
    if (info.color_type, info.bit_depth) != (ColorType::Grayscale, BitDepth::Eight) {
        let kind = kind(info.color_type, info.bit_depth);
        return Err(PngError::Kind { file: file(), kind });
    }
    if u64::from(info.width) * u64::from(info.height) > MOST_PIXELS as u64 {
        return Err(PngError::TooLarge {
            file: file(),
            columns: info.width,
            rows: info.height,
        });
    }
    let (rows, columns) = (info.height as usize, info.width as usize);
    (picture.rows, picture.columns) = (rows, columns);
    picture.pixels.resize(rows * columns, 0);
    reader.next_frame(&mut picture.pixels).map_err(broken)?;
    Ok(())
}

/// Writes a grey picture of 8 bits a pixel, fast enough for the pictures of a running camera.
pub fn write_grey(path: &Path, picture: &Picture) -> Result<(), PngError> {
    let size = [picture.rows, picture.columns];
    write(
        path,
        ColorType::Grayscale,
        Compression::Fast,
        size,
        &picture.pixels,
    )
}

/// Writes a picture of 8 bits each of red, green and blue, as small as it gets.
pub fn write_rgb(path: &Path, rows: usize, columns: usize, pixels: &[u8]) -> Result<(), PngError> {
    write(path, ColorType::Rgb, Compression::High, [rows, columns], pixels)
}

fn write(
    path: &Path,
    colour: ColorType,
    compression: Compression,
    [rows, columns]: [usize; 2],
    pixels: &[u8],
) -> Result<(), PngError> {
    let written = File::create(path)
        .map_err(EncodingError::IoError)
        .and_then(|file| {
            let mut encoder = Encoder::new(BufWriter::new(file), columns as u32, rows as u32);
            encoder.set_color(colour);
            encoder.set_depth(BitDepth::Eight);
            encoder.set_compression(compression);
            let mut writer = encoder.write_header()?;
            writer.write_image_data(pixels)?;
            writer.finish()
        });
    written.map_err(|source| PngError::Write {
        file: path.display().to_string(),
        source,
    })
}

/// Kind of a picture's pixels in words.
fn kind(colour: ColorType, depth: BitDepth) -> String {
    let colour = match colour {
        ColorType::Grayscale => "grey pixels",
        ColorType::GrayscaleAlpha => "grey pixels with transparency",
        ColorType::Rgb => "coloured pixels",
        ColorType::Rgba => "coloured pixels with transparency",
        ColorType::Indexed => "pixels of a palette",
    };
    format!("{colour} of {} bits a channel", depth as u8)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::tempdir;

    fn picture(rows: usize, columns: usize) -> Picture {
        Picture {
            capture: 3,
            time_us: 4,
            rows,
            columns,
            pixels: (0..rows * columns).map(|k| (7 * k % 251) as u8).collect(),
        }
    }

    /// A PNG file that says that it has a side of 200,000 pixels, and has none.
    #[test]
    fn a_picture_larger_than_any_camera_s_is_refused_by_its_header() {
        let folder = tempdir().expect("a folder");
        let path = folder.path().join("large.png");
        let mut encoder = Encoder::new(File::create(&path).expect("a file"), 200_000, 200_000);
        encoder.set_color(ColorType::Grayscale);
        encoder.set_depth(BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a header");
        // The beginning of pixels, of which there are no more.
        writer
            .write_chunk(::png::chunk::IDAT, &[0x78, 0x01])
            .expect("a chunk");
        drop(writer);
        let mut read = Picture::default();
        let error = read_grey(&path, &mut read)
            .expect_err("it is too large")
            .to_string();
        assert!(
            error.contains("200000 × 200000 pixels; at most 67 million"),
            "{error}"
        );
        assert!(read.pixels.is_empty());
    }

    #[test]
    fn a_grey_picture_comes_back_and_keeps_its_room() {
        let folder = tempdir().expect("a folder");
        let path = folder.path().join("grey.png");
        let written = picture(60, 80);
        write_grey(&path, &written).expect("written");
        let mut read = picture(60, 80);
        read.pixels.fill(0);
        let room = read.pixels.as_ptr();
        read_grey(&path, &mut read).expect("read");
        assert_eq!(read, written);
        assert_eq!(read.pixels.as_ptr(), room);
        assert_eq!(read.image().map(|image| image.row(1)[0]), Ok(written.pixels[80]));
    }

    #[test]
    fn what_is_no_grey_picture_is_told_by_its_file() {
        let folder = tempdir().expect("a folder");
        let scratch = |name: &str| folder.path().join(name);
        let mut into = picture(1, 1);
        let mut said = |path: &Path| read_grey(path, &mut into).expect_err("refused").to_string();
        assert!(said(&scratch("none.png")).contains("none.png: No such file"));

        let text = scratch("text.png");
        std::fs::write(&text, "no picture").expect("written");
        let error = said(&text);
        assert!(
            error.contains("text.png is not a PNG file, or is damaged"),
            "{error}"
        );

        let colours = scratch("colours.png");
        write_rgb(&colours, 2, 2, &[9; 12]).expect("written");
        let error = said(&colours);
        assert!(
            error.contains("colours.png has coloured pixels of 8 bits a channel"),
            "{error}"
        );

        let deep = scratch("deep.png");
        let mut encoder = Encoder::new(File::create(&deep).expect("a file"), 1, 1);
        encoder.set_depth(BitDepth::Sixteen);
        let mut writer = encoder.write_header().expect("a header");
        writer.write_image_data(&[1, 2]).expect("pixels");
        drop(writer);
        let error = said(&deep);
        assert!(error.contains("grey pixels of 16 bits a channel"), "{error}");

        let whole = scratch("whole.png");
        write_grey(&whole, &picture(60, 80)).expect("written");
        let bytes = std::fs::read(&whole).expect("read");
        let cut = scratch("cut.png");
        std::fs::write(&cut, &bytes[..bytes.len() / 2]).expect("written");
        let error = said(&cut);
        assert!(
            error.contains("cut.png is not a PNG file, or is damaged"),
            "{error}"
        );
    }

    #[test]
    fn a_picture_that_cannot_be_written_is_told() {
        let folder = tempdir().expect("a folder");
        let nowhere = folder.path().join("no-folder/a.png");
        let error = write_grey(&nowhere, &picture(2, 2))
            .expect_err("refused")
            .to_string();
        assert!(error.contains("a.png: No such file"), "{error}");
        let mut few = picture(2, 2);
        few.pixels.pop();
        let error = write_grey(&folder.path().join("few.png"), &few)
            .expect_err("refused")
            .to_string();
        assert!(error.contains("cannot write picture"), "{error}");
    }
}

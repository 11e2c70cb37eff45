//! What is rendered of a true position measures as where the seam truly is; and what a scene file may say.

use super::*;
use crate::TrueSeams;
use crate::seams::tests::{heads, wavy_seam};
use crate::tests::{axes_at, machine};
use camera::nominal_slopes;
use config::calibration::Calibration;
use config::machine::{JointForm, MachineFile};
use host_link::record::MachinePosition;
use nalgebra::Vector3;
use shared::io::SLIDES;
use vision::{Detector, Joint, Measured, Prior, Walls};

fn cameras(joint: JointForm, mount_deg: f64) -> CameraConfig {
    let text = include_str!("../../../../machines/dual-beam-gantry.toml");
    let machine = MachineFile::parse("m.toml", text).unwrap();
    let mut cameras = machine.tracking.unwrap().cameras;
    cameras.joint = joint;
    cameras.mount_deg = [mount_deg, -mount_deg];
    cameras
}

/// The machine near path position `s` of the bent path, and slides that have the seam in sight, `off` \[mm\] beside it.
fn standing(seams: &TrueSeams, s: f64, off: [f64; 2]) -> (MachinePosition, [f64; SLIDES]) {
    let (mut pose, _) = wavy_seam().planned(s).unwrap();
    pose.position += Vector3::new(0.02, -0.03, 0.05);
    let mut slides = [0.0; SLIDES];
    for side in 0..SIDES {
        let (_, crossing) = seams
            .facing(side, &heads().spot(&pose, side), heads().camera_lead())
            .unwrap();
        slides[2 * side] = crossing.u - off[0];
        slides[2 * side + 1] = crossing.v - off[1];
    }
    (MachinePosition::Axes(axes_at(&pose)), slides)
}

/// Of a camera that is mounted right.
fn standpoint(slides: &[f64; SLIDES], side: usize) -> Standpoint {
    Standpoint {
        side,
        slides_mm: [slides[2 * side], slides[2 * side + 1]],
        turned: 0.0,
        lead_mm: heads().camera_lead(),
    }
}

fn picture(
    camera: &mut RenderedCamera,
    tell: &Sender<FieldOfView>,
    capture: u32,
    view: View,
) -> (Arrival, Picture) {
    let mut picture = Picture::default();
    camera.strobed(capture, u64::from(capture) * 5_000);
    tell.send(FieldOfView::Seam(view)).unwrap();
    let arrival = camera.next(Duration::from_secs(10), &mut picture).unwrap();
    (arrival, picture)
}

fn measured(calibration: &Calibration, joint: Joint, picture: &Picture) -> Measured {
    let (optics, noise) = (calibration.optics, calibration.photon_transfer);
    let mut detector = Detector::new(optics, noise, calibration.profile).unwrap();
    let (track, focus) = (None, 0.0);
    let prior = Prior { joint, track, focus };
    let report = detector.measure(&picture.image().unwrap(), &prior).unwrap();
    *report.seam().unwrap_or_else(|| panic!("{report:?}"))
}

/// How far the measurement of a picture is beside the true seam, across and along the camera's view \[mm\].
fn miss(
    seams: &TrueSeams,
    calibration: &Calibration,
    side: usize,
    at: &MachinePosition,
    slides: &[f64; SLIDES],
    seen: &Measured,
) -> [f64; 2] {
    let told = calibration.side_measurement(seen.lateral_mm, seen.travel_mm, seen.height_mm);
    let spot = heads().spot(&machine().pose(at), side);
    let lead = heads().camera_lead() + told.along_mm;
    let (_, truth) = seams.facing(side, &spot, lead).unwrap();
    let u = slides[2 * side] + told.delta_u_mm - truth.u;
    let v = slides[2 * side + 1] + told.delta_v_mm - truth.v;
    calibration.camera_step(u, v)
}

/// For gaps seen along the skin's normal and a little beside it, and for corners along their bisector and beside it. One
/// picture of a corner without learnt walls is good for 5 µm; the tracker gets means.
#[test]
fn what_is_measured_in_rendered_pictures_is_where_the_seam_truly_is() {
    const PICTURES: u32 = 6;
    let (machine, seams) = (machine(), TrueSeams::of([wavy_seam()]));
    let forms = [
        (JointForm::Gap, -30.0),
        (JointForm::Gap, -24.0),
        (JointForm::Corner, 15.0),
        (JointForm::Corner, 11.0),
    ];
    for (form, mount_deg) in forms {
        let cameras = cameras(form, mount_deg);
        let world = RenderedWorld::new(&SceneFile::default(), &cameras, &heads(), 1);
        for side in 0..SIDES {
            let calibration = cameras.nominal(side);
            let joint = match form {
                JointForm::Gap => Joint::Gap,
                JointForm::Corner => Joint::Corner(Walls {
                    slopes: nominal_slopes(form, calibration.slides.mount_rad(), &heads(), side),
                    sigma: 0.01,
                }),
            };
            let offsets = [[0.1, -0.05], [-0.15, 0.1], [0.02, 0.12]];
            let (mut camera, tell) = world.camera(side);
            for (off, from) in offsets.into_iter().zip([170.0, 250.0, 330.0]) {
                let mut sum = [0.0; 2];
                for i in 0..PICTURES {
                    let (position, slides) = standing(&seams, from + 0.4 * f64::from(i), off);
                    let view = View::of(
                        &cameras,
                        &machine,
                        &seams,
                        None,
                        &position,
                        &standpoint(&slides, side),
                    )
                    .unwrap();
                    let (_, picture) = picture(&mut camera, &tell, i, view);
                    let seen = measured(&calibration, joint, &picture);
                    let miss = miss(&seams, &calibration, side, &position, &slides, &seen);
                    sum = [0, 1].map(|k| sum[k] + miss[k] / f64::from(PICTURES));
                }
                let at = format!("{form:?} {mount_deg}° side {side} s {from}: {sum:.4?}");
                assert!(sum[0].abs() < 0.005 && sum[1].abs() < 0.015, "{at}");
            }
        }
    }
}

#[test]
fn a_camera_that_is_turned_sees_the_seam_turned_about_its_way() {
    let (machine, seams) = (machine(), TrueSeams::of([wavy_seam()]));
    let cameras = cameras(JointForm::Gap, -30.0);
    for side in 0..SIDES {
        let (position, slides) = standing(&seams, 250.0, [0.1, -0.05]);
        let seen = |turned: f64| {
            let standpoint = Standpoint {
                turned,
                ..standpoint(&slides, side)
            };
            let view = View::of(&cameras, &machine, &seams, None, &position, &standpoint).unwrap();
            let ViewForm::Plate { roll, .. } = view.form else {
                panic!("a gap is in a plate");
            };
            ([view.lateral_mm, view.height_mm], roll.atan())
        };
        let turn = 0.02;
        let (([u, n], roll), ([turned_u, turned_n], turned_roll)) = (seen(0.0), seen(turn));
        let (sin, cos) = turn.sin_cos();
        assert!(
            (turned_u - (u * cos + n * sin)).abs() < 1e-9,
            "{side}: {turned_u}"
        );
        assert!(
            (turned_n - (n * cos - u * sin)).abs() < 1e-9,
            "{side}: {turned_n}"
        );
        assert!(
            (turned_roll - roll + turn).abs() < 2e-3,
            "{side}: {turned_roll} {roll}"
        );
    }
}

/// A view of a seam in sight.
fn level(along_mm: f64) -> View {
    View {
        along_mm,
        lateral_mm: 0.0,
        height_mm: 0.0,
        form: ViewForm::Plate {
            pitch: 0.0,
            roll: 0.0,
            yaw_rad: 0.0,
        },
    }
}

fn scene(text: &str) -> Result<SceneFile, String> {
    SceneFile::parse("scene.toml", text).map_err(|error| error.to_string())
}

/// The arrivals of the pictures of captures, and which of them are black.
fn run(text: &str, seed: u64, captures: impl Iterator<Item = u32>) -> Vec<(Arrival, Picture)> {
    let cameras = cameras(JointForm::Gap, -30.0);
    let world = RenderedWorld::new(&scene(text).unwrap(), &cameras, &heads(), seed);
    let (mut camera, tell) = world.camera(0);
    captures
        .map(|number| picture(&mut camera, &tell, number, level(0.4 * f64::from(number))))
        .collect()
}

#[test]
fn a_picture_belongs_to_its_capture_and_seed_whatever_was_before() {
    let disturbed = "spatter_share = 0.5\nheight_noise_um = 5.0";
    let all = run(disturbed, 1, 0..6);
    let last = run(disturbed, 1, 5..6);
    assert_eq!(all[5], last[0]);
    assert_ne!(all[5].1.pixels, run(disturbed, 2, 5..6)[0].1.pixels);
}

#[test]
fn pictures_are_lost_and_late_by_their_shares() {
    let lost = run("lost_share = 0.25", 1, 0..80);
    let count = lost
        .iter()
        .filter(|(arrival, _)| matches!(arrival, Arrival::Lost { .. }))
        .count();
    assert!((10..30).contains(&count), "{count} of 80");
    let cameras = cameras(JointForm::Gap, -30.0);
    let late = scene("late_share = 0.25\nlate_ms = 12").unwrap();
    let world = RenderedWorld::new(&late, &cameras, &heads(), 1);
    let late: Vec<u64> = (0..80).map(|capture| world.late_us(capture, 1)).collect();
    assert!(late.iter().all(|us| *us == 0 || *us == 12_000));
    assert!((10..30).contains(&late.iter().filter(|us| **us > 0).count()));
}

#[test]
fn a_light_fails_where_and_as_long_as_the_file_says() {
    // A picture every 5 ms and 0.4 mm.
    let dark = |text: &str| -> Vec<u32> {
        let pictures = run(text, 1, 0..20);
        let black = |picture: &Picture| picture.pixels.iter().all(|pixel| *pixel < 7);
        let dark = pictures.iter().filter(|(_, picture)| black(picture));
        dark.map(|(_, picture)| picture.capture).collect()
    };
    let spell = "[[dark]]\nside = 1\nfrom_s_mm = 2.0\nfor_ms = 20";
    assert_eq!(dark(spell), [5, 6, 7, 8]);
    assert_eq!(dark("[[dark]]\nside = 1\nfrom_s_mm = 6.0"), [15, 16, 17, 18, 19]);
    assert_eq!(dark("[[dark]]\nside = 2\nfrom_s_mm = 2.0"), [0; 0]);
}

#[test]
fn far_from_any_seam_it_is_dark_and_without_a_known_place_the_picture_is_lost() {
    let cameras = cameras(JointForm::Gap, -30.0);
    let world = RenderedWorld::new(&SceneFile::default(), &cameras, &heads(), 1);
    let (mut camera, tell) = world.camera(0);
    let mut picture = Picture::default();
    camera.strobed(1, 0);
    let nothing = camera.next(Duration::ZERO, &mut picture).unwrap();
    assert_eq!(nothing, Arrival::Nothing);
    tell.send(FieldOfView::Nothing).unwrap();
    assert_eq!(
        camera.next(Duration::ZERO, &mut picture).unwrap(),
        Arrival::Picture
    );
    assert!(picture.pixels.len() == 120_000 && picture.pixels.iter().all(|pixel| *pixel == 0));
    camera.strobed(2, 0);
    tell.send(FieldOfView::Unknown).unwrap();
    let lost = camera.next(Duration::ZERO, &mut picture).unwrap();
    assert_eq!(lost, Arrival::Lost { capture: 2 });
}

#[test]
fn a_wrong_scene_is_told_by_key_value_and_what_it_may_be() {
    for (text, said) in [
        (
            "spater_share = 0.05",
            "scene.toml, line 1: unknown field `spater_share`",
        ),
        (
            "\ntexture = [\"ground\", \"wood\"]",
            "line 2: texture: unknown variant `wood`",
        ),
        (
            "lost_share = 1.5",
            "scene.toml: lost_share is 1.5, but must be from 0 to 1",
        ),
        ("smear_um = 1e15", "but must be from 0 to 50 µm"),
        ("gap_wave_length_mm = 1e-300", "but must be from 1 to 100000 mm"),
        (
            "gap_mm = 0.02\ngap_wave_mm = 0.03",
            "gap_mm - gap_wave_mm is -0.0",
        ),
        (
            "[[dark]]\nside = 3\nfrom_s_mm = 0.0",
            "side of dark 1 is 3, but must be 1 or 2",
        ),
        (
            "[[scratch]]\nside = 1\noffset_mm = 0.2\nwidth_mm = 0.0\nbrightness = 0.5",
            "width_mm of scratch 1 is 0",
        ),
        (
            "[[plate]]\nbrightness = 0.1",
            "side of plate 1 is 0, but must be 1 or 2",
        ),
        (
            "[[plate]]\nside = 1\nplate = \"upper\"",
            "line 3: plate.plate: unknown variant `upper`",
        ),
        (
            "[[plate]]\nside = 1\n[[plate]]\nside = 2\nchamfer_um = -5",
            "chamfer_um of plate 2 is -5, but must be from 0 to 1000 µm",
        ),
        (
            "[[tack]]\nside = 1\nwidth_mm = 0.3\nbrightness = 1\nfrom_s_mm = 20\nto_s_mm = 10",
            "to_s_mm - from_s_mm of tack 1 is -10, but must be 0 mm or more",
        ),
        (
            "[[grooves]]\nside = 1\npitch_mm = 0.1\nwidth_mm = 0.2\nbrightness = 0.1",
            "pitch_mm - width_mm of grooves 1 is -0.1",
        ),
        (
            "[[joint]]\nside = 2\nstep_mm = 3",
            "step_mm of joint 1 is 3, but must be from -1 to 1 mm",
        ),
        (
            "[sensor]\nfull_well_factor = 0",
            "full_well_factor of sensor is 0, but must be from 0.01 to 100",
        ),
    ] {
        let error = scene(text).unwrap_err();
        assert!(error.contains(said), "{error}");
    }
}

#[test]
fn shipped_scenes_are_understood() {
    let disturbed = include_str!("../../../../programs/t-seam-400-disturbed.toml");
    assert_eq!(scene(disturbed).unwrap().scratch.len(), 2);
    let stretches = scene(include_str!("../../../../programs/t-seam-400-stretches.toml")).unwrap();
    let [dim, chamfered] = stretches.plate[..] else {
        panic!("{:?}", stretches.plate);
    };
    assert_eq!((dim.side, dim.plate, dim.brightness), (1, Plates::Right, 0.08));
    assert_eq!((chamfered.plate, chamfered.brightness), (Plates::Left, 1.0));
}

/// Means of a picture over the left part of it, the right part, and the middle of the row of the seam.
fn parts(picture: &Picture) -> [f64; 3] {
    let mean = |rows: std::ops::Range<usize>, columns: std::ops::Range<usize>| {
        let count = rows.len() * columns.len();
        let lines = rows.map(|row| &picture.pixels[row * picture.columns..][columns.clone()]);
        lines.flatten().map(|&x| f64::from(x)).sum::<f64>() / count as f64
    };
    let (rows, columns) = (picture.rows, picture.columns);
    [
        mean(0..rows, 0..columns / 3),
        mean(0..rows, 2 * columns / 3..columns),
        mean(rows / 2 - 5..rows / 2 + 5, columns / 2 - 4..columns / 2 + 4),
    ]
}

#[test]
fn a_stretch_of_the_seam_looks_as_the_file_says() {
    // Pictures every 4 mm, of 1.5 mm to each side: those at 8, 12 and 16 mm have it.
    let look = |table: &str| -> Vec<[f64; 3]> {
        let text = format!("{table}\nside = 1\nfrom_s_mm = 6.3\nto_s_mm = 17.7");
        let pictures = run(&text, 1, (0..80).step_by(10));
        pictures.iter().map(|(_, picture)| parts(picture)).collect()
    };
    let plain = look("[[plate]]");
    assert_eq!(plain, look("[[plate]]\nbrightness = 1.0"));
    // Of the part of a picture that there is most to see in: as bright as without it, times a factor.
    let check = |table: &str, part: usize, factor: std::ops::Range<f64>| {
        for (k, (seen, plain)) in look(table).iter().zip(&plain).enumerate() {
            let ratio = seen[part] / plain[part];
            let here = [2, 3, 4].contains(&k);
            let wanted = if here { &factor } else { &(0.99..1.01) };
            assert!(wanted.contains(&ratio), "{table}, picture {k}: {ratio}");
        }
    };
    check("[[plate]]\nplate = \"left\"\nbrightness = 0.1", 0, 0.08..0.12);
    check("[[plate]]\nplate = \"left\"\nbrightness = 0.1", 1, 0.99..1.01);
    check("[[plate]]\nplate = \"right\"\nbrightness = 0.3", 1, 0.28..0.32);
    check("[[joint]]\ngap_mm = 0.0", 2, 8.0..60.0);
    check("[[tack]]\nwidth_mm = 0.3\nbrightness = 0.5", 2, 4.0..30.0);
    check("[[stray_light]]\nveil = 0.25", 0, 1.4..1.6);
    check("[[stray_light]]\nglare = 0.25\nat = [1, 0]", 1, 1.1..1.6);
    check(
        "[[dirt]]\nat = [-0.7, 0]\nradius = 0.5\nfactor = 0.2",
        0,
        0.3..0.8,
    );
    check(
        "[[grooves]]\npitch_mm = 0.2\nwidth_mm = 0.1\nbrightness = 0.1",
        0,
        0.5..0.6,
    );
    check(
        "[[grooves]]\nrun = \"across\"\npitch_mm = 0.2\nwidth_mm = 0.1\nbrightness = 0.1",
        1,
        0.5..0.6,
    );
    // A plate that is not there from 2.9 to 9.1 mm: none of it is seen in the middle of that.
    let missing = look("[[plate]]\nplate = \"right\"\nmissing = true");
    assert!(missing[3][1] < 0.1 * plain[3][1] && missing[3][0] > 0.99 * plain[3][0]);
    assert!(missing[0][1] > 0.99 * plain[0][1] && missing[6][1] > 0.99 * plain[6][1]);
}

#[test]
fn light_sensor_and_textures_differ_where_the_file_says() {
    let level = |text: &str| -> Vec<f64> {
        let pictures = run(text, 1, (0..40).step_by(4));
        pictures.iter().map(|(_, picture)| parts(picture)[0]).collect()
    };
    let deviation = |levels: &[f64]| {
        let mean = levels.iter().sum::<f64>() / levels.len() as f64;
        let squares = levels.iter().map(|level| (level / mean - 1.0).powi(2));
        (squares.sum::<f64>() / levels.len() as f64).sqrt()
    };
    assert!(deviation(&level("")) < 0.03);
    assert!((0.1..0.4).contains(&deviation(&level("flicker_share = 0.2"))));
    let noisy = |text: &str| {
        let pictures = run(text, 1, 3..4);
        let row = pictures[0].1.pixels.chunks_exact(400).next().unwrap().to_vec();
        row.windows(2)
            .map(|v| (f64::from(v[0]) - f64::from(v[1])).powi(2))
            .sum::<f64>()
    };
    // The first row is far out of focus: what differs between neighbours is noise.
    assert!(noisy("[sensor]\nfull_well_factor = 0.1") > 4.0 * noisy(""));
    assert!(noisy("[sensor]\npattern = 0.03") > 4.0 * noisy(""));
    let other = run("right_texture = [\"rolled\", \"rolled\"]", 1, 3..4);
    let same = run("", 1, 3..4);
    let row = |pictures: &[(Arrival, Picture)]| pictures[0].1.pixels[150 * 400..][..400].to_vec();
    let (other, same) = (row(&other), row(&same));
    let differ =
        |columns: std::ops::Range<usize>| columns.filter(|&k| other[k].abs_diff(same[k]) > 3).count();
    assert!(differ(0..150) == 0 && differ(250..400) > 75);
}

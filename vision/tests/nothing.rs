//! Pictures of nothing that is welded: leaves, clouds and noise.

use vision::render::SplitMix64;
use vision::{Detector, Image, Joint, Optics, PhotonTransfer, Prior, Profile};

const NOISE: PhotonTransfer = PhotonTransfer {
    full_well: 20_000.0,
    read_noise: 15.0,
};
const SIZE: [usize; 2] = [150, 200];
const PICTURES: u64 = 100;

/// Discs over discs, their radii r spread as 1/r³: edges, corners and dark spaces of all sizes, as in photographs (the dead
/// leaves model of Lee, Mumford and Huang, 2001).
fn leaves(random: &mut SplitMix64) -> Vec<f64> {
    let [rows, columns] = SIZE.map(|size| size as f64);
    let mut picture = vec![0.0; SIZE[0] * SIZE[1]];
    for _ in 0..1500 {
        // Radii of 2 pixels on.
        let radius = 2.0 / (1.0 - 0.999 * random.uniform()).sqrt();
        let middle = [
            random.between(-20.0, rows + 20.0),
            random.between(-20.0, columns + 20.0),
        ];
        let level = random.between(0.0, 250.0);
        let inside = |at: f64, size: usize| {
            (at - radius).ceil().max(0.0) as usize
                ..((at + radius).floor() + 1.0).clamp(0.0, size as f64) as usize
        };
        for row in inside(middle[0], SIZE[0]) {
            for column in inside(middle[1], SIZE[1]) {
                if (row as f64 - middle[0]).hypot(column as f64 - middle[1]) < radius {
                    picture[row * SIZE[1] + column] = level;
                }
            }
        }
    }
    picture
}

/// Noise of all sizes, each as strong: clouds.
fn clouds(random: &mut SplitMix64) -> Vec<f64> {
    let mut picture = vec![0.0; SIZE[0] * SIZE[1]];
    for octave in 0..7 {
        let pitch = f64::from(1 << octave);
        let size = SIZE.map(|size| (size as f64 / pitch) as usize + 2);
        let knots: Vec<f64> = (0..size[0] * size[1]).map(|_| random.gauss()[0]).collect();
        for (place, value) in picture.iter_mut().enumerate() {
            let at = [place / SIZE[1], place % SIZE[1]].map(|at| at as f64 / pitch);
            let [(row, down), (column, right)] = at.map(|at| (at as usize, at.fract()));
            let knot = |row: usize, column: usize| knots[row * size[1] + column];
            let line = |row: usize| knot(row, column) * (1.0 - right) + knot(row, column + 1) * right;
            *value += 25.0 * (line(row) * (1.0 - down) + line(row + 1) * down);
        }
    }
    picture.iter().map(|value| 110.0 + value).collect()
}

fn noise(random: &mut SplitMix64) -> Vec<f64> {
    let level = random.between(10.0, 200.0);
    let scatter = random.between(1.0, 60.0);
    (0..SIZE[0] * SIZE[1])
        .map(|_| level + scatter * random.gauss()[0])
        .collect()
}

#[test]
fn nothing_is_believed_in_pictures_of_something_else() {
    let optics = Optics {
        magnification: 4.0,
        pixel_mm: 0.0276,
        tilt_rad: std::f64::consts::FRAC_PI_4,
        aperture: 0.10,
        wavelength_mm: 0.000_55,
        rows: SIZE[0],
        columns: SIZE[1],
    };
    let mut detector = Detector::new(optics, NOISE, Profile::expected(&optics)).unwrap();
    let prior = Prior {
        joint: Joint::Gap,
        track: None,
        focus: 0.0,
    };
    let kinds: [fn(&mut SplitMix64) -> Vec<f64>; 3] = [leaves, clouds, noise];
    for (kind, make) in kinds.into_iter().enumerate() {
        let believed: Vec<u64> = (0..PICTURES)
            .filter(|seed| {
                let picture = make(&mut SplitMix64::new(*seed));
                let grey = picture.iter().map(|level| level.round().clamp(0.0, 255.0) as u8);
                let pixels: Vec<u8> = grey.collect();
                let image = Image::new(&pixels, SIZE[0], SIZE[1]).unwrap();
                detector.measure(&image, &prior).unwrap().seam().is_some()
            })
            .collect();
        assert!(believed.is_empty(), "{kind}: {believed:?} of {PICTURES}");
    }
}

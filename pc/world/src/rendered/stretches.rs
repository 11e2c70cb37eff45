//! Gives a scene what the scene file says of stretches of the seam.

use super::scene_effects::{Direction, Grooves, Plate, Plates, Stretch};
use super::scene_file::SceneFile;
use vision::PhotonTransfer;
use vision::render::{Joint, Mark, Scene, Side, SplitMix64, Tack};

/// How far from the middle of a picture grooves are rendered \[mm\].
const REACH_MM: f64 = 1.5;

/// One picture of a seam.
pub(super) struct Stretches<'a> {
    pub file: &'a SceneFile,
    /// 0 or 1.
    pub side: usize,
    /// Where on the seam the picture is \[mm\].
    pub along_mm: f64,
    /// Electrons that are calibrated.
    pub noise: PhotonTransfer,
}

impl Stretches<'_> {
    /// Gives it all that is there.
    pub fn give(&self, scene: &mut Scene, random: &mut SplitMix64) {
        if let Joint::Gap(_) = scene.joint {
            self.join(scene);
            let plates = self.file.plate.iter();
            for plate in plates.filter(|plate| usize::from(plate.side) == self.side + 1) {
                self.lay_plate(scene, plate);
            }
            for tack in self.file.tack.iter().filter(|tack| self.is_mine(*tack)) {
                scene.tacks.push(Tack {
                    reaches_mm: self.on_the_work(scene, tack),
                    width_mm: tack.width_mm,
                    brightness: tack.brightness,
                });
            }
        }
        for grooves in self.file.grooves.iter().filter(|grooves| self.is_mine(*grooves)) {
            self.groove(scene, grooves);
        }
        for light in self.file.stray_light.iter().filter(|light| self.is_here(*light)) {
            scene.film.veil += light.veil;
            scene.film.glares.extend(light.spot());
        }
        let dirt = self.file.dirt.iter().filter(|dirt| self.is_here(*dirt));
        scene.film.dirt.extend(dirt.map(|dirt| dirt.spot()));
        let sensor = &self.file.sensor;
        if (sensor.full_well_factor, sensor.read_noise_factor) != (1.0, 1.0) {
            scene.sensor.noise = Some(PhotonTransfer {
                full_well: self.noise.full_well * sensor.full_well_factor,
                read_noise: self.noise.read_noise * sensor.read_noise_factor,
            });
        }
        scene.sensor.pattern = sensor.pattern;
        scene.sensor.seed = self.side as u64;
        scene.curvature_mm = 1e-3 * self.file.field_curvature_um;
        if self.file.flicker_share > 0.0 {
            let [off, _] = random.gauss();
            scene.light.level *= (1.0 + self.file.flicker_share * off).max(0.0);
        }
    }

    fn is_here(&self, stretch: &impl Stretch) -> bool {
        stretch.is_at(self.side, self.along_mm)
    }

    /// Whether it is on this seam, wherever.
    fn is_mine(&self, stretch: &impl Stretch) -> bool {
        usize::from(stretch.stretch().0) == self.side + 1
    }

    /// Its ends along travel on the work \[mm\].
    fn on_the_work(&self, scene: &Scene, stretch: &impl Stretch) -> [f64; 2] {
        let begin = scene.position_mm[0] - self.along_mm;
        stretch.reaches_mm().map(|end| end + begin)
    }

    fn join(&self, scene: &mut Scene) {
        for stretch in self.file.joint.iter().filter(|stretch| self.is_here(*stretch)) {
            let Joint::Gap(gap) = &mut scene.joint else { return };
            gap.plate.width_mm = stretch.gap_mm.unwrap_or(gap.plate.width_mm);
            gap.step_mm += stretch.step_mm;
            let lower = usize::from(stretch.step_mm < 0.0);
            if stretch.shadow_um > 0.0 && stretch.step_mm != 0.0 {
                scene.sides[lower].shadow = [1e-3 * stretch.shadow_um, stretch.shadow_factor];
            }
        }
    }

    fn lay_plate(&self, scene: &mut Scene, plate: &Plate) {
        let ends = self.on_the_work(scene, plate);
        let middle = scene.position_mm[0];
        let sides = match plate.plate {
            Plates::Left => 0..1,
            Plates::Right => 1..2,
            Plates::Both => 0..2,
        };
        for side in &mut scene.sides[sides] {
            if plate.missing {
                // A picture shows one end of it: the nearer one.
                let first = (middle - ends[0]).abs() < (middle - ends[1]).abs();
                let [from, to] = &mut side.reaches_mm;
                match ends {
                    [f64::NEG_INFINITY, f64::INFINITY] => *side = Side::missing(),
                    [end, _] if first => *to = to.min(end),
                    [_, end] => *from = from.max(end),
                }
            } else if self.is_here(plate) {
                side.brightness *= plate.brightness;
                side.chamfer_mm = side.chamfer_mm.max(1e-3 * plate.chamfer_um);
                side.rounding_mm = side.rounding_mm.max(1e-3 * plate.rounding_um);
                side.burr_mm = side.burr_mm.max(1e-3 * plate.burr_um);
                side.edge_factor *= plate.edge_factor;
                side.wall_brightness = side.wall_brightness.max(plate.wall_brightness);
                if plate.line_um > 0.0 {
                    side.rim = [1e-3 * plate.line_um, plate.line_factor];
                }
            }
        }
    }

    fn groove(&self, scene: &mut Scene, grooves: &Grooves) {
        let reaches_mm = self.on_the_work(scene, grooves);
        let middle = scene.position_mm[0];
        if middle + REACH_MM < reaches_mm[0] || middle - REACH_MM > reaches_mm[1] {
            return;
        }
        let count = (REACH_MM / grooves.pitch_mm) as i64;
        let first = match grooves.run {
            Direction::Along => 0.0,
            // They keep their places on the work.
            Direction::Across => (middle / grooves.pitch_mm).round() * grooves.pitch_mm,
        };
        for k in -count..=count {
            let at = first + k as f64 * grooves.pitch_mm;
            let (width, factor) = (grooves.width_mm, grooves.brightness);
            let mark = match grooves.run {
                Direction::Along => Mark::along(at, width, factor),
                Direction::Across => Mark::across(at, width, factor),
            };
            scene.marks.push(Mark { reaches_mm, ..mark });
        }
    }
}

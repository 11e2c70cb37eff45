//! The work as it would look without lens, pixels and travel.

use super::marks::within;
use super::scene::{Gap, Joint, Root, Scene};
use super::side::{Face, slant};
use super::sight_line::Point;
use super::texture::{Field, roughness};
use crate::optics::Optics;

/// Light from wall to wall fades by 1/e over this \[mm\].
const FADING_MM: f64 = 0.1;

/// Textures of a scene, and how its sides appear.
#[derive(Clone, Debug, Default)]
pub(super) struct Sharp {
    /// One for a plate, one for the right wall of a corner, one for the right plate if it has its own.
    fields: Vec<Field>,
    /// Of the sides of a gap, if there is anything about them.
    faces: Option<[Face; 2]>,
}

impl Sharp {
    /// Makes the textures of a scene, unless they are those of the last one.
    pub fn prepare(&mut self, scene: &Scene, optics: &Optics) {
        self.faces = match &scene.joint {
            Joint::Gap(gap) if scene.has_effects() => {
                Some(Face::both(&scene.sides, slant(&gap.plate, optics)))
            }
            _ => None,
        };
        let made = |k: usize| self.fields.get(k).map(Field::texture);
        if made(0) == Some(scene.texture) && made(2) == scene.right_texture {
            return;
        }
        let mut other = scene.texture;
        other.seed = !other.seed;
        let textures = [scene.texture, other].into_iter().chain(scene.right_texture);
        self.fields = textures.map(Field::new).collect();
    }

    /// Brightness at a point of the work, its usual mean being 1. Edges are as soft as a sample of `sample` mm is wide.
    pub fn brightness(&self, scene: &Scene, point: &Point, sample: f64) -> f32 {
        let [along, across] = [
            scene.position_mm[0] + point.along,
            scene.position_mm[1] + point.across,
        ];
        let field = match scene.joint {
            Joint::Gap(_) if point.side == 1 && self.fields.len() > 2 => 2,
            Joint::Gap(_) => 0,
            Joint::Corner(_) => point.side,
        };
        // Where along travel the seam is beside the point.
        let place = match &scene.joint {
            Joint::Gap(gap) if self.faces.is_some() => along + point.lateral * gap.plate.yaw_rad.sin(),
            _ => along,
        };
        let texture = f64::from(self.fields[field].at(along, across));
        let mut brightness = texture;
        for stripe in &scene.stripes {
            let inside = (stripe.width_mm / 2.0 - (point.lateral - stripe.offset_mm).abs()) / sample + 0.5;
            brightness *= 1.0 + (stripe.factor - 1.0) * inside.clamp(0.0, 1.0);
        }
        for mark in &scene.marks {
            brightness *= 1.0 + (mark.factor - 1.0) * mark.share(place, point.lateral, sample);
        }
        match (&scene.joint, &self.faces) {
            (Joint::Gap(gap), Some(faces)) => {
                let places = [along, place];
                let [surface, open, wall] = with_effects(scene, gap, faces, places, point.lateral, sample);
                brightness = brightness * surface + gap.brightness * open + wall;
            }
            (Joint::Gap(gap), None) if gap.plate.width_mm > 0.0 => {
                let open = opening(gap, scene.texture.seed, along, point.lateral, sample);
                brightness += (gap.brightness - brightness) * open;
            }
            (Joint::Gap(_), None) => {}
            (Joint::Corner(root), _) => brightness *= root.lit(point.lateral, point.side),
        }
        for tack in &scene.tacks {
            let share = tack.share(place, point.lateral, sample);
            brightness += (tack.brightness * texture - brightness) * share;
        }
        for blob in &scene.blobs {
            let [a, u] = blob.middle_mm;
            let far = (along - a).hypot(scene.position_mm[1] + point.across - u);
            let inside = ((blob.radius_mm - far) / sample + 0.5).clamp(0.0, 1.0);
            brightness += (blob.brightness - brightness) * inside;
        }
        brightness as f32
    }
}

/// What two sides make of a sample: what multiplies the surface, the share that lies in the gap or where a plate is
/// missing, and the light of the walls. Its places are along travel on the work: its own, and that of the seam beside it.
fn with_effects(
    scene: &Scene,
    gap: &Gap,
    faces: &[Face; 2],
    [along, place]: [f64; 2],
    lateral: f64,
    sample: f64,
) -> [f64; 3] {
    let mut seen = [0.0, 1.0, 0.0];
    let width = gap.plate.width_mm;
    for (edge, (side, face)) in scene.sides.iter().zip(faces).enumerate() {
        let there = within(side.reaches_mm, place, sample);
        let out = if width > 0.0 && gap.roughness_mm > 0.0 {
            gap.roughness_mm * roughness(scene.texture.seed, edge, along)
        } else {
            0.0
        };
        let outward = if edge == 0 { -lateral } else { lateral };
        let x = outward - width / 2.0 - out;
        let covered = ((x - face.begins) / sample + 0.5).clamp(0.0, 1.0) * there;
        seen[0] += covered * face.factor(x, sample);
        seen[1] -= covered;
        if width > 0.0 {
            seen[2] += face.wall_at(x) * there;
        }
    }
    seen[1] = seen[1].max(0.0);
    seen[2] *= seen[1];
    seen
}

/// Share of a sample that lies in the gap.
fn opening(gap: &Gap, seed: u64, along: f64, lateral: f64, sample: f64) -> f64 {
    let half = gap.plate.width_mm / 2.0;
    if lateral.abs() > half + 6.0 * gap.roughness_mm + sample {
        return 0.0;
    }
    let out = |edge: usize| {
        if gap.roughness_mm == 0.0 {
            0.0
        } else {
            gap.roughness_mm * roughness(seed, edge, along)
        }
    };
    let left = ((lateral + half + out(0)) / sample + 0.5).clamp(0.0, 1.0);
    let right = ((half + out(1) - lateral) / sample + 0.5).clamp(0.0, 1.0);
    (left + right - 1.0).max(0.0)
}

impl Root {
    /// What lights a wall at `lateral` mm from the root.
    fn lit(&self, lateral: f64, side: usize) -> f64 {
        self.brightness[side] * self.interreflected(lateral)
    }

    /// What light from wall to wall multiplies a wall's brightness by.
    pub(super) fn interreflected(&self, lateral: f64) -> f64 {
        1.0 + self.interreflection * (-lateral.abs() / FADING_MM).exp()
    }
}

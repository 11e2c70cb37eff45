//! The work as it would look without lens, pixels and travel.

use super::scene::{Gap, Joint, Root, Scene};
use super::sight_line::Point;
use super::texture::{Field, roughness};

/// Light from wall to wall fades by 1/e over this \[mm\].
const FADING_MM: f64 = 0.1;

/// Textures of a scene: one for a plate, one for each wall of a corner.
#[derive(Clone, Debug, Default)]
pub(super) struct Sharp {
    fields: Vec<Field>,
}

impl Sharp {
    /// Makes the textures of a scene, unless they are those of the last one.
    pub fn prepare(&mut self, scene: &Scene) {
        if self
            .fields
            .first()
            .is_some_and(|field| field.texture() == scene.texture)
        {
            return;
        }
        let mut other = scene.texture;
        other.seed = !other.seed;
        self.fields = vec![Field::new(scene.texture), Field::new(other)];
    }

    /// Brightness at a point of the work, its usual mean being 1. Edges are as soft as a sample of `sample` mm is wide.
    pub fn brightness(&self, scene: &Scene, point: &Point, sample: f64) -> f32 {
        let [along, across] = [
            scene.position_mm[0] + point.along,
            scene.position_mm[1] + point.across,
        ];
        let wall = match scene.joint {
            Joint::Gap(_) => 0,
            Joint::Corner(_) => point.side,
        };
        let mut brightness = f64::from(self.fields[wall].at(along, across));
        for stripe in &scene.stripes {
            let inside = (stripe.width_mm / 2.0 - (point.lateral - stripe.offset_mm).abs()) / sample + 0.5;
            brightness *= 1.0 + (stripe.factor - 1.0) * inside.clamp(0.0, 1.0);
        }
        match &scene.joint {
            Joint::Gap(gap) if gap.plate.width_mm > 0.0 => {
                let open = opening(gap, scene.texture.seed, along, point.lateral, sample);
                brightness += (gap.brightness - brightness) * open;
            }
            Joint::Gap(_) => {}
            Joint::Corner(root) => brightness *= root.lit(point.lateral, point.side),
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

//! Random seams from picture to picture, with effects that come and go.

use super::effect::Effect;
use super::joints::{Draw, random_joint};
use super::marks::{Mark, Run};
use super::motion::{CYCLE_S, Motion};
use super::protocol::{SPEEDS_MM_S, Sight};
use super::random::SplitMix64;
use super::scene::{Joint, Scene};
use super::texture::Texture;
use crate::noise::PhotonTransfer;
use crate::observer::Moved;
use crate::optics::Optics;
use std::ops::Range;

/// Pictures of one seam, 200 a second, by a camera that travels along it at 5–9 m/min while its slides move; some of
/// them in a row have effects.
///
/// Marks and tacks begin and end on the work, plates that end begin again; other effects are there in all of these pictures
/// and in no other. Each picture comes with what the camera has moved since the one before.
#[derive(Clone, Debug)]
pub struct EffectRun {
    base: Scene,
    with: Scene,
    effects: Vec<Effect>,
    draw: Draw,
    motion: Motion,
    lasting: Range<usize>,
    taken: usize,
}

impl EffectRun {
    /// The seam of a seed, with `effects` in the pictures that `lasting` counts.
    pub fn new(
        effects: &[Effect],
        lasting: Range<usize>,
        optics: &Optics,
        noise: PhotonTransfer,
        seed: u64,
    ) -> Self {
        let mut base = random_joint(&[], optics, noise, seed);
        let mut with = random_joint(effects, optics, noise, seed);
        if let (Joint::Gap(base), Joint::Gap(with)) = (&mut base.joint, &with.joint) {
            base.plate.roll = with.plate.roll;
        }
        let mut motion = Motion::new(&base);
        if effects.contains(&Effect::Smear) {
            // Longer exposures: it goes no faster.
            let mut random = SplitMix64::new(seed);
            let speed = random.between(SPEEDS_MM_S[0], SPEEDS_MM_S[1]);
            base.smear_mm = with.smear_mm;
            motion.pitch_mm = speed * CYCLE_S;
        }
        let place = |picture: usize| with.position_mm[0] + picture as f64 * motion.pitch_mm;
        let reaches_mm = [place(lasting.start), place(lasting.end)];
        for mark in &mut with.marks {
            if mark.run == Run::Along {
                (mark.at_mm, mark.reaches_mm) = (reaches_mm[0], reaches_mm);
            }
        }
        for tack in &mut with.tacks {
            tack.reaches_mm = reaches_mm;
        }
        let along = |mark: &&Mark| mark.run == Run::Along;
        base.marks = with.marks.iter().filter(along).copied().collect();
        base.tacks = with.tacks.clone();
        Self {
            motion,
            base,
            with,
            effects: effects.to_vec(),
            draw: Draw {
                random: SplitMix64::new(!seed),
                noise,
                sight: Sight::new(optics),
            },
            lasting,
            taken: 0,
        }
    }

    /// Whether the next picture has the effects.
    pub fn has_effects(&self) -> bool {
        self.lasting.contains(&self.taken)
    }

    /// Textures left and right, which the tiles of a fast renderer have to have.
    pub fn textures(&self) -> [Texture; 2] {
        self.base.textures()
    }

    /// Lets plates that end do so where the effects begin, and begin again where they end.
    fn end_plates(&self, scene: &mut Scene) {
        let place = |picture: usize| self.with.position_mm[0] + picture as f64 * self.motion.pitch_mm;
        let [from, to] = [place(self.lasting.start), place(self.lasting.end)];
        let middle = (from + to) / 2.0;
        for (side, with) in scene.sides.iter_mut().zip(&self.with.sides) {
            if with.reaches_mm != [f64::NEG_INFINITY, f64::INFINITY] {
                side.reaches_mm = if scene.position_mm[0] < middle {
                    [f64::NEG_INFINITY, from]
                } else {
                    [to, f64::INFINITY]
                };
            }
        }
    }
}

impl Iterator for EffectRun {
    type Item = (Scene, Moved);

    fn next(&mut self) -> Option<(Scene, Moved)> {
        let moved = self.motion.go(&mut self.draw.random);
        let affected = self.has_effects();
        self.taken += 1;
        let mut scene = if affected {
            self.with.clone()
        } else {
            self.base.clone()
        };
        self.motion.place(&mut scene);
        self.end_plates(&mut scene);
        if affected {
            let travel = self.motion.travel_mm;
            let across = scene.marks.iter_mut().filter(|mark| mark.run == Run::Across);
            across.for_each(|mark| mark.offset_mm += travel);
            scene.blobs.clear();
            if let (true, Joint::Gap(gap)) = (self.effects.contains(&Effect::SpatterOnEdge), scene.joint) {
                let band = scene.position_mm[0] + self.motion.at[0];
                self.draw.spatter(&mut scene, &gap.plate, band);
            }
        }
        Some((scene, moved))
    }
}

//! Ready and tracking: where the slides should be, and one tick towards it.

use super::TrackerController;
use crate::io::{Command, DacCode, SLIDES, SlideCommand};
use crate::protocol::PERMIT_US;
use crate::state::{TrackerFault, TrackerState};
use crate::tracking::history::PathSnapshot;
use crate::tracking::law::{LawFlag, SlideTarget};
use crate::tracking::map::Off;
use crate::tracking::parameters::TrackerParameters;
use crate::tracking::seam::{RealHead, SeamTarget, plan};
use crate::tracking::search::Meanwhile;

/// A slide that should go beyond its travel and is as near as this to the end has gone as far as it can \[mm\].
const AT_THE_END: f64 = 0.1;
/// A path that goes no faster stands \[mm/s\].
const STANDS: f64 = 1e-3;
/// A beam may still burn for so long when its permit is withdrawn: until the last one given has ended, a tick after it \[s\].
const BURNS_ON_S: f64 = PERMIT_US as f64 * 1e-6 + 1e-3;

impl<const KNOTS: usize> TrackerController<KNOTS> {
    /// Ready and tracking: one tick of the control law toward seam, plan or rest.
    pub(super) fn follow(
        &mut self,
        parameters: &TrackerParameters,
        motion_now: Option<u64>,
        snapshot: Option<&PathSnapshot>,
    ) -> SlideCommand {
        let on_path = snapshot.filter(|p| p.path_id == self.path.id());
        if on_path.is_some() && !self.on_path {
            self.jog = None;
        }
        self.on_path = on_path.is_some();
        let tracking = on_path.is_some_and(|p| p.tracking) && self.path.len() >= 2;
        if self.state == TrackerState::Tracking && snapshot.is_none() {
            let silent_ms = motion_now.map_or(u64::MAX, |now| self.silent_us(now)) / 1000;
            self.report(TrackerFault::PathStale {
                silent_ms: u32::try_from(silent_ms).unwrap_or(u32::MAX),
            });
        }
        if tracking && self.state == TrackerState::Ready {
            self.jog = None;
            self.seam.begin();
            self.seam_searches = Default::default();
            for slide in &mut self.slides {
                slide.arrived = false;
                slide.on_seam = false;
            }
        }
        if !tracking && self.state == TrackerState::Tracking {
            // Should there be no plan to follow, stay here.
            for slide in &mut self.slides {
                slide.target = slide.position;
            }
        }
        self.state = if tracking {
            TrackerState::Tracking
        } else {
            TrackerState::Ready
        };
        let plan = on_path.and_then(|p| plan(parameters, &self.path, p.s, p.speed));
        let targets = match (plan, on_path, self.jog_targets()) {
            (Some(plan), Some(snapshot), _) if tracking => self.seam_targets(parameters, snapshot, &plan),
            (_, _, Some(jog)) => jog,
            (Some(plan), ..) => plan.map(Some),
            (None, ..) => self.slides.map(|slide| Some(SlideTarget::rest(slide.target))),
        };
        let mut command = Command::SAFE;
        command.enable = true;
        for (i, target) in targets.into_iter().take(parameters.slides.len()).enumerate() {
            command.dac[i] = self.drive(parameters, i, target);
        }
        command
    }

    /// Targets while tracking: the seam where it is known, the next place that is where it is not; a search about the
    /// last place or the plan where there is none; no target where it was lost. All relative to where the heads
    /// really are.
    fn seam_targets(
        &mut self,
        parameters: &TrackerParameters,
        snapshot: &PathSnapshot,
        plan: &[SlideTarget; SLIDES],
    ) -> [Option<SlideTarget>; SLIDES] {
        // Of the newest state as it was: an extrapolated pose would show a bend of the path as a deviation.
        let newest = self.history.newest();
        let mut targets = [None; SLIDES];
        for side in parameters.heads.sides() {
            let (u, v) = (2 * side, 2 * side + 1);
            let head = newest
                .as_ref()
                .and_then(|(newest, _)| RealHead::new(&parameters.heads, &self.path, newest, side));
            let off = head.map_or([0.0; 2], |head| head.off());
            let sights = [u, v].map(|slide| self.seam.sight(parameters, slide, snapshot));
            let mut in_plan =
                [u, v].map(|slide| SlideTarget::rest(self.slides[slide].position + off[slide - u]));
            let looks = self.looks(parameters, snapshot, side, off, &sights, [&plan[u], &plan[v]]);
            for (i, sight) in sights.iter().enumerate() {
                if let Some(target) = self.in_plan(snapshot, u + i, sight, looks[i]) {
                    in_plan[i] = target;
                }
            }
            let real = head.map_or(in_plan, |head| head.targets(in_plan));
            for (i, sight) in sights.into_iter().enumerate() {
                let slide = &mut self.slides[u + i];
                let short = real[i].position - slide.position;
                let away = libm::fabs(short);
                let seen = matches!(sight, SeamTarget::Seam(_));
                slide.arrived |= seen && away <= parameters.map.gate;
                slide.on_seam = seen && away <= parameters.lock;
                targets[u + i] = (!matches!(sight, SeamTarget::Lost)).then_some(real[i]);
                let follows = matches!(sight, SeamTarget::Seam(_) | SeamTarget::Jump(_));
                if follows && snapshot.speed >= 0.0 {
                    // As far from its target there as here, where the head may be turned.
                    let here = in_plan[i].position - short;
                    self.stay_on_seam(parameters, snapshot, u + i, here, &in_plan[i]);
                }
            }
        }
        targets
    }

    /// A beam goes off before its spot is beside the seam, and does not go on there: by what was seen of where it would be
    /// until a permit that is withdrawn now has ended. The slide is at `position` \[mm\] in the frame of the plan, and
    /// goes on with its target.
    fn stay_on_seam(
        &mut self,
        parameters: &TrackerParameters,
        snapshot: &PathSnapshot,
        slide: usize,
        position: f64,
        target: &SlideTarget,
    ) {
        let (s, speed) = (snapshot.s, snapshot.speed);
        let worst = [0.0, BURNS_ON_S]
            .into_iter()
            .filter_map(|ahead| {
                let there = position + target.velocity * ahead;
                self.seam
                    .off(parameters, slide, (s + speed * ahead, speed), there)
            })
            .fold(Off::By(0.0), |worst, off| match (worst, off) {
                (Off::By(a), Off::By(b)) => Off::By(libm::fmax(a, b)),
                _ => Off::Lost,
            });
        let s_mm = s as f32;
        let fault = match worst {
            Off::By(off) if off <= parameters.unlock => return,
            Off::By(off) => TrackerFault::BesideSeam {
                slide: slide as u8,
                off_mm: off as f32,
                s_mm,
            },
            Off::Lost => TrackerFault::LostSeam {
                side: slide as u8 / 2,
                s_mm,
            },
        };
        self.slides[slide].on_seam = false;
        if snapshot.beams[slide / 2] {
            self.report(fault);
        }
    }

    /// Where the slides of `side` look for a seam that neither its picture nor the map shows, in the frame of the plan: about
    /// where they met it last, or the plan. `off` is how far the spot is off its planned place \[mm\].
    fn looks(
        &mut self,
        parameters: &TrackerParameters,
        snapshot: &PathSnapshot,
        side: usize,
        off: [f64; 2],
        sights: &[SeamTarget; 2],
        plan: [&SlideTarget; 2],
    ) -> [SlideTarget; 2] {
        let last = [0, 1].map(|i| match sights[i] {
            SeamTarget::Nowhere(last) => (true, last),
            _ => (false, None),
        });
        let about = [0, 1].map(|i| last[i].1.unwrap_or(*plan[i]));
        if !(last[0].0 && last[1].0) {
            return about;
        }
        let never_met = last[0].1.is_none() && last[1].1.is_none();
        let meanwhile = if snapshot.beams[side] {
            Meanwhile::Other
        } else if snapshot.speed > STANDS {
            Meanwhile::Goes
        } else if never_met && snapshot.speed >= -STANDS {
            Meanwhile::Stands
        } else {
            Meanwhile::Other
        };
        // The travels, seen from where the planned path would have the head.
        let travels = [0, 1].map(|i| {
            let (min, max) = parameters.slides[2 * side + i].law.travel;
            (min + off[i], max + off[i])
        });
        self.seam_searches[side].step(&parameters.search, about, travels, meanwhile)
    }

    /// Where a slide should be in the frame of the plan, by what its camera saw, or where it `looks` for the seam. `None`
    /// where the seam was lost.
    fn in_plan(
        &mut self,
        snapshot: &PathSnapshot,
        slide: usize,
        sight: &SeamTarget,
        looks: SlideTarget,
    ) -> Option<SlideTarget> {
        let side = slide / 2;
        match sight {
            SeamTarget::Seam(seam) => Some(*seam),
            SeamTarget::Jump(seam) => {
                self.slides[slide].arrived = false;
                Some(*seam)
            }
            SeamTarget::Ahead(beginning) => {
                self.not_there_yet(slide, snapshot);
                Some(*beginning)
            }
            SeamTarget::Nowhere(_) => {
                self.not_there_yet(slide, snapshot);
                Some(looks)
            }
            SeamTarget::Lost => {
                self.report(TrackerFault::LostSeam {
                    side: side as u8,
                    s_mm: snapshot.s as f32,
                });
                None
            }
        }
    }

    /// Slide `i` is on its way to a seam that was not seen where its spot is.
    fn not_there_yet(&mut self, i: usize, snapshot: &PathSnapshot) {
        if snapshot.beams[i / 2] {
            self.report(TrackerFault::SeamNotSeen {
                side: i as u8 / 2,
                s_mm: snapshot.s as f32,
            });
        }
        self.slides[i].arrived = false;
    }

    /// One tick of the control law of slide `i`.
    fn drive(&mut self, parameters: &TrackerParameters, i: usize, target: Option<SlideTarget>) -> DacCode {
        let slide = &mut self.slides[i];
        // What lies beyond the travel is not gone after.
        let (min, max) = parameters.slides[i].law.travel;
        let beyond = target.is_some_and(|t| t.position < min || t.position > max);
        let target = target.map(|t| SlideTarget {
            position: t.position.clamp(min, max),
            ..t
        });
        slide.target = target.map_or(slide.position, |t| t.position);
        let at_the_end = beyond && libm::fabs(slide.position - slide.target) <= AT_THE_END;
        let law = &parameters.slides[i].law;
        let output = match &self.jog {
            Some(jog) => slide.law.step(&jog.slowed(law), target, slide.position),
            None => slide.law.step(law, target, slide.position),
        };
        slide.saturated_ticks = match output.flag {
            LawFlag::Saturated => slide.saturated_ticks.saturating_add(1),
            LawFlag::Free | LawFlag::NoTarget | LawFlag::SoftLimit => 0,
        };
        if self.state == TrackerState::Tracking {
            // On its first way to the seam a slide is as fast as it can be; that takes a whole travel at most.
            let first_way = if slide.arrived {
                0
            } else {
                parameters.slides[i].travel_ticks
            };
            let (ms, position_mm) = (slide.saturated_ticks, slide.position as f32);
            let slide = i as u8;
            if ms > parameters.saturation_ticks.saturating_add(first_way) {
                self.report(TrackerFault::Saturated { slide, ms });
            }
            if at_the_end || output.flag == LawFlag::SoftLimit {
                self.report(TrackerFault::SoftLimit { slide, position_mm });
            }
        }
        output.dac
    }
}

//! What pictures of real joints have that plain ones have not.

use super::random::SplitMix64;

/// What a picture has beside a plain joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    Plain,
    /// One plate has 30 to 90 % of the other's brightness.
    Ratio,
    /// One plate has 3 to 20 % of the other's brightness.
    DimPlate,
    /// The plates are 20 to 100 µm offset, and the lower one lies in the other's shadow.
    Step,
    /// Offset by 0.1 to 0.2 mm.
    HighStep,
    /// Only one plate is in sight.
    OnePlate,
    /// One plate begins or ends in the picture.
    OnePlateEnds,
    /// Both plates end in the picture.
    PlateEnds,
    /// A tack begins or ends in the picture, or covers it.
    Tack,
    /// Spatter hides one edge.
    SpatterOnEdge,
    /// A closed joint.
    Closed,
    /// A closed joint with a dark scratch along it.
    ClosedScratched,
    /// A closed joint with regular grooves along it.
    ClosedGrooved,
    /// A dark scratch beside the gap.
    Scratch,
    /// Bright lines along the edges, and a dark scratch beside the gap.
    BrightEdgesScratch,
    /// Bright lines along the edges, 2 to 5 times the plate.
    BrightEdges,
    /// Regular grooves beside the gap.
    Grooves,
    /// Regular grooves across the seam.
    GroovesAcross,
    /// One to three dark scratches across the seam.
    ScratchAcross,
    /// A chamfer of 15 to 40 µm on one side.
    Chamfer,
    /// Chamfers on both.
    Chamfers,
    /// A rolled edge of 20 to 60 µm.
    RolledEdge,
    /// A burr of 10 to 40 µm, as bright as the plate to 2.5 times as bright.
    Burr,
    /// Lit walls of the gap, at a roll of 6 to 10°.
    LitWalls,
    /// A veil of 10 to 50 %.
    Veil,
    /// Glare.
    Glare,
    /// The glow of the plume: wide, and over the whole picture.
    Plume,
    /// The light is 0.4 to 1.6 times the usual.
    Flicker,
    /// One to four spots of dirt on the window.
    Dirt,
    /// More noise than is calibrated.
    Noise,
    /// Pixels' gains that differ by 0.5 to 2 %.
    Pattern,
    /// Best focus in the picture's corners is 10 to 50 µm off that in the middle.
    Curvature,
    /// 15 to 40 µm of travel during the exposure.
    Smear,
}

impl Effect {
    /// All of them.
    pub const ALL: [Self; 33] = [
        Self::Plain,
        Self::Ratio,
        Self::DimPlate,
        Self::Step,
        Self::HighStep,
        Self::OnePlate,
        Self::OnePlateEnds,
        Self::PlateEnds,
        Self::Tack,
        Self::SpatterOnEdge,
        Self::Closed,
        Self::ClosedScratched,
        Self::ClosedGrooved,
        Self::Scratch,
        Self::BrightEdgesScratch,
        Self::BrightEdges,
        Self::Grooves,
        Self::GroovesAcross,
        Self::ScratchAcross,
        Self::Chamfer,
        Self::Chamfers,
        Self::RolledEdge,
        Self::Burr,
        Self::LitWalls,
        Self::Veil,
        Self::Glare,
        Self::Plume,
        Self::Flicker,
        Self::Dirt,
        Self::Noise,
        Self::Pattern,
        Self::Curvature,
        Self::Smear,
    ];

    /// Whether a joint with it may have a seam to be measured; what a picture shows, its
    /// [`truth`](Scene::truth) says.
    pub fn has_seam(self) -> bool {
        !matches!(
            self,
            Self::OnePlate | Self::Closed | Self::ClosedScratched | Self::ClosedGrooved
        )
    }

    /// Two to four different effects, with a seam to be measured.
    pub fn mixed(random: &mut SplitMix64) -> Vec<Self> {
        let count = 2 + (3.0 * random.uniform()) as usize;
        let mut effects: Vec<Self> = Vec::new();
        while effects.len() < count {
            let effect = Self::ALL[(random.uniform() * Self::ALL.len() as f64) as usize];
            if effect.has_seam() && effect != Self::Plain && !effects.contains(&effect) {
                effects.push(effect);
            }
        }
        effects
    }
}

//! An operator who teaches by hand.

use super::*;

/// Farther out the machine refuses to go \[mm\].
const REACH: f64 = 850.0;

#[derive(Debug, thiserror::Error, PartialEq)]
#[error("out of reach")]
struct OutOfReach;

/// A world with limits.
struct ByHand(World);

impl CameraMachine for ByHand {
    type Error = OutOfReach;

    fn approach(&mut self, machine_pose: &MachinePose) -> Result<(), OutOfReach> {
        self.go(machine_pose)
    }

    fn go(&mut self, machine_pose: &MachinePose) -> Result<(), OutOfReach> {
        if machine_pose.pose.position.y > REACH {
            return Err(OutOfReach);
        }
        let Ok(()) = self.0.go(machine_pose);
        Ok(())
    }

    fn look(&mut self, pictures: usize) -> Result<View, OutOfReach> {
        let Ok(view) = self.0.look(pictures);
        Ok(view)
    }

    fn taught(&mut self, point: &SeamPoint) -> Result<(), OutOfReach> {
        let Ok(()) = self.0.taught(point);
        Ok(())
    }

    fn enough(&mut self) -> bool {
        false
    }
}

impl JogOperator for ByHand {
    fn line(&mut self) -> Result<Option<String>, OutOfReach> {
        Ok(self.0.lines.next().map(str::to_owned))
    }

    fn say(&mut self, text: &str) {
        self.0.told.push(text.to_owned());
    }

    fn untaught(&mut self, points: &[SeamPoint]) -> Result<(), OutOfReach> {
        self.0.taught = points.to_vec();
        Ok(())
    }

    fn is_refusal(&self, _error: &OutOfReach) -> bool {
        true
    }
}

fn jog(lines: impl Into<Vec<&'static str>>, before: &[SeamPoint]) -> World {
    let mut hand = ByHand(World::new(straight, 0.0));
    hand.0.lines = lines.into().into_iter();
    let (cameras, config) = (cameras(), SeamTeaching::default());
    let follower = Follower::build(&cameras, &config, None).unwrap();
    let from = start(straight, [0.0, 0.3, 0.0]);
    let ended = follower.jog(&mut hand, &from, before).unwrap();
    assert_eq!(ended, Ended::Operator);
    hand.0
}

#[test]
fn points_are_taken_where_the_operator_leads_the_head() {
    let world = jog(
        [
            "take", "centre", "take", "step 5", "take", "x 10", "y -0.2", "a 1", "up 0.1", "u1 0.1",
            "v2 0.1", "take", "done", "take",
        ],
        &[],
    );
    let places: Vec<Vector3<f64>> = world.taught.iter().map(SeamPoint::middle).collect();
    assert_eq!(places.len(), 3, "{:?}", world.told);
    for (place, x) in places.iter().zip([500.0, 505.0, 515.0]) {
        // Taken as it is measured, centred or not.
        assert!((place - Vector3::new(x, 800.0, 100.0)).norm() < 0.02, "{place}");
    }
    assert!((world.taught[2].s_mm - 15.0).abs() < 0.02);
    let told = &world.told[0];
    assert!(
        told.contains("X490.00 Y800.30")
            && told.contains("side 1: U +")
            && told.contains("gap 0.050 mm, quality 0.90"),
        "{told}"
    );
}

#[test]
fn what_cannot_be_done_is_said_and_nothing_is_lost() {
    let world = jog(
        [
            "undo", "centre", "take", "fly", "x", "y 300", "y 99", "y 5", "take", "search", "y -5", "u3",
            "step 4", "take", "take", "step 3", "take", "undo", "x 1 2", "take 3",
        ],
        &[],
    );
    assert_eq!(world.taught.len(), 2, "{:?}", world.told);
    let told = world.told.join("\n");
    for said in [
        "no point is taken",
        "fly is not a command here",
        "x needs a number [mm]",
        "300 mm is more than 100 mm at once",
        "out of reach",
        "both seams must be visible to take a point",
        "no seam is seen on either side",
        "u3 is not a command here",
        "not beyond the last point",
        "2 points",
        "2 is too much",
        "take takes no number, not 3",
    ] {
        assert!(told.contains(said), "{said} is not in\n{told}");
    }
}

#[test]
fn by_hand_too_a_lesson_goes_on_after_its_last_point() {
    let before = jog(["centre", "take", "step 8", "take"], &[]).taught;
    let after = jog(["step", "take"], &before).taught;
    assert_eq!(after.len(), 1);
    assert!((after[0].s_mm - 24.0).abs() < 1e-3, "{}", after[0].s_mm);
}

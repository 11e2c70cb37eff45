//! Programs through points that were taught without an error.

use super::*;
use crate::Part;
use cam::path::{PlannedPath, Planner};
use config::machine::MachineFile;
use nc::{Options, interpret};
use shared::geometry::angle;
use std::path::Path;

const MACHINE: &str = include_str!("../../../../../machines/ac-head.toml");
const PANEL: &str = include_str!("../../../../../programs/panel.toml");

fn machine() -> MachineFile {
    MachineFile::parse("ac-head.toml", MACHINE).unwrap()
}

fn panel() -> Panel {
    match toml::from_str(PANEL).unwrap() {
        Part::Panel(panel) => *panel,
        other => panic!("{other:?}"),
    }
}

/// The points of the true surface at `guides`.
fn exact(panel: &Panel, guides: &[Vector3<f64>]) -> Vec<TaughtPoint> {
    let surface = panel.simulated_surface().unwrap();
    let point = |guide: &Vector3<f64>| {
        let (position, normal) = surface.nearest(guide).unwrap();
        TaughtPoint {
            position,
            normal,
            error: 0.0,
            rings: 2,
            time_s: 6.0,
        }
    };
    guides.iter().map(point).collect()
}

fn shipped(panel: &Panel) -> Vec<TaughtPoint> {
    let guides: Vec<_> = panel.guides().iter().map(|guide| guide.position).collect();
    exact(panel, &guides)
}

fn plan(panel: &Panel, points: Vec<TaughtPoint>, machine: &MachineFile) -> anyhow::Result<Plan> {
    let mut panel = panel.clone();
    panel.set_points(points);
    panel.plan(&PartContext {
        machine,
        directory: Path::new(""),
        title: "panel",
    })
}

/// What is said of why there is no program.
fn refused(panel: &Panel, points: Vec<TaughtPoint>) -> String {
    plan(panel, points, &machine()).unwrap_err().to_string()
}

fn paths(plan: &Plan, machine: &MachineFile) -> Vec<PlannedPath> {
    let program = interpret(&plan.program, Options::default()).unwrap();
    let planner = Planner::build(machine).unwrap();
    planner
        .program(&program, &machine.planning.park_axes(), None)
        .unwrap()
}

/// Largest distance of the cut from the true surface \[mm\], and largest angle of the tool with its normal \[deg\].
fn errors(panel: &Panel, plan: &Plan, machine: &MachineFile) -> (f64, f64) {
    let surface = panel.simulated_surface().unwrap();
    let paths = paths(plan, machine);
    let cuts: Vec<_> = paths.iter().filter(|path| path.weld().is_some()).collect();
    assert_eq!(cuts.len(), 1);
    let (start, end) = cuts[0].weld().unwrap();
    let path = cuts[0].path();
    let (mut off, mut lean) = (0.0f64, 0.0f64);
    for i in 0..=2000 {
        let pose = path
            .at(start + (end - start) * f64::from(i) / 2000.0)
            .unwrap()
            .pose()
            .unwrap();
        let (foot, normal) = surface.nearest(&pose.position).unwrap();
        off = off.max((pose.position - foot).norm());
        lean = lean.max(angle(&normal, &pose.normal).to_degrees());
    }
    (off, lean)
}

#[test]
fn the_shipped_cut_stays_on_the_panel_and_along_its_normals() {
    let (machine, panel) = (machine(), panel());
    let plan = plan(&panel, shipped(&panel), &machine).unwrap();
    let (off, lean) = errors(&panel, &plan, &machine);
    assert!(off < 0.01, "{off} mm");
    // It passes the vertical at 1.7°: there the tool leans.
    assert!(lean < 2.0, "{lean}°");
    assert!(plan.notes[1].contains("near the vertical"), "{:?}", plan.notes);
}

/// Lengths and spacings whose sums round one way or another.
#[test]
fn every_cut_opens_its_beam_once_and_shuts_it_where_it_ends() {
    let (machine, mut panel) = (machine(), panel());
    let points = shipped(&panel);
    for every in 1..=5 {
        let points: Vec<_> = points.iter().copied().step_by(every).collect();
        for tenths in 18..=40 {
            panel.spacing_mm = f64::from(tenths) / 10.0;
            let plan = plan(&panel, points.clone(), &machine).unwrap();
            let outputs = plan.program.lines().filter_map(|line| {
                let word = line.split(' ').nth(1)?;
                word.starts_with("M6").then_some(&line[line.find('M')?..])
            });
            let outputs: Vec<_> = outputs.filter(|output| !output.starts_with("M67")).collect();
            assert_eq!(outputs, ["M62 P0", "M63 P0"], "{every}, {} mm", panel.spacing_mm);
        }
    }
}

#[test]
fn over_the_crown_a_changes_its_sign_and_c_stays() {
    let (machine, panel) = (machine(), panel());
    let points: Vec<_> = (-4..=4)
        .map(|i| {
            Vector3::new(
                900.0 + 15.0 * f64::from(i),
                700.0 + 1e-3 * f64::from(i % 3),
                150.0,
            )
        })
        .collect();
    let plan = plan(&panel, exact(&panel, &points), &machine).unwrap();
    let (off, lean) = errors(&panel, &plan, &machine);
    assert!(off < 0.01 && lean < 0.05, "{off} mm, {lean}°");
    let words = |name: char| {
        let blocks = plan.program.lines().filter(|line| line.contains(" G1 "));
        let value = move |line: &str| {
            let word = line.split(' ').find(|word| word.starts_with(name))?;
            word[1..].parse::<f64>().ok()
        };
        blocks.filter_map(value).collect::<Vec<_>>()
    };
    let (a, c) = (words('A'), words('C'));
    assert!(a[0] * a[a.len() - 1] < 0.0);
    assert!(c.iter().all(|at| (at - c[0]).abs() < 0.1), "{c:?}");
}

#[test]
fn a_closed_cut_ends_where_it_begins() {
    let (machine, mut panel) = (machine(), panel());
    panel.closed = true;
    let points: Vec<_> = (0..14)
        .map(|i| f64::from(i) / 14.0 * std::f64::consts::TAU)
        .map(|phi| Vector3::new(1000.0 + 40.0 * phi.cos(), 700.0 + 40.0 * phi.sin(), 130.0))
        .collect();
    let plan = plan(&panel, exact(&panel, &points), &machine).unwrap();
    let (off, lean) = errors(&panel, &plan, &machine);
    assert!(off < 0.02 && lean < 0.1, "{off} mm, {lean}°");
    let paths = paths(&plan, &machine);
    let cut = paths.iter().find(|path| path.weld().is_some()).unwrap();
    let (start, end) = cut.weld().unwrap();
    let at = |s: f64| cut.path().at(s).unwrap().pose().unwrap().position;
    assert!(
        (at(start) - at(end)).norm() < 1e-3,
        "{}",
        (at(start) - at(end)).norm()
    );
}

#[test]
fn an_untaught_panel_says_how_to_teach_it() {
    let machine = machine();
    let context = PartContext {
        machine: &machine,
        directory: Path::new(""),
        title: "panel",
    };
    let error = panel().plan(&context).unwrap_err().to_string();
    assert!(error.contains("seamwright teach"), "{error}");
}

#[test]
fn what_the_limits_forbid_is_named_with_its_point() {
    let shifted = |by: Vector3<f64>| {
        let mut points = shipped(&panel());
        for point in &mut points {
            point.position += by;
        }
        points
    };
    let text = refused(&panel(), shifted(Vector3::new(2000.0, 0.0, 0.0)));
    assert!(
        text.contains("point 10") && text.contains("travel of X"),
        "{text}"
    );
    let text = refused(&panel(), shifted(Vector3::new(0.0, 0.0, 200.0)));
    assert!(text.contains("safe height of 250 mm"), "{text}");
    let mut fast = panel();
    fast.speed_m_min = 20.0;
    let text = refused(&fast, shipped(&fast));
    assert!(text.contains("of C near taught point"), "{text}");
    let mut points = shipped(&panel());
    points.truncate(2);
    assert!(refused(&panel(), points).contains("at least 3"));
    let mut still = panel();
    still.spacing_mm = 0.0;
    assert!(refused(&still, shipped(&still)).contains("spacing_mm is 0"));
}

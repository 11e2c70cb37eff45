//! The PC's part of Seamwright: programs, planning, sessions with the boards, reports.

pub mod boards;
pub mod calibration;
pub mod camera;
pub mod cli;
pub mod curve;
pub mod dry_run;
pub mod evaluate;
pub mod machine;
pub mod measure;
pub mod metrics;
pub mod nc;
pub mod part;
pub mod path;
pub mod plan;
pub mod record;
pub mod report;
pub mod seam;
pub mod table;
pub mod teach;
pub mod unwelded;
pub mod weld;
pub mod world;

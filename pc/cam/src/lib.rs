//! Planning for one machine: programs to paths that boards run, and how long a job takes.

pub mod along;
pub mod attitude;
pub mod curve;
pub mod dry_run;
pub mod metrics;
pub mod path;

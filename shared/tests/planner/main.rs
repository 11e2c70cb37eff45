//! The trajectory planner from outside: random programs on every machine, and fixed cases whose answer is known.
//! Everything is judged by the positions that come out, a millisecond apart.

mod bench;
mod contour;
mod fixed;
mod hands;
mod judge;
mod late;
mod program;
mod random;
mod regressions;
mod run;
mod unreachable;

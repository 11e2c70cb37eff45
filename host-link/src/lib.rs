//! The PC's part of Seamwright: programs, planning, sessions with the boards, reports.

pub mod boards;
pub mod machine;
pub mod nc;

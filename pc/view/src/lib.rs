//! What there is to see at the operator's screen, and the pages that show it: at the screen itself, at a viewer, in a browser.
//!
//! Nothing here has a way to a board, a job or a socket: it is built for browsers too. Pages for looking are drawn from one type,
//! [`seen::Seen`].
//!
//! - [`drawn`]: what pages draw of a program.
//! - [`seen`]: all that pages for looking are drawn from.
//! - [`live`]: what is known of a job, folded from its events; bounded, however long the job.
//! - [`texts`]: everything that the screen says, in every language.
//! - [`fonts`]: letters for Chinese, where the system has none.
//! - [`look`]: language, size and contrast.
//! - [`access`]: levels of those who use the screen, as they are told.
//! - [`viewing`]: what a viewer is told, and what it knows from that.
//! - [`screen`]: the pages.

pub mod access;
pub mod drawn;
pub mod fonts;
pub mod live;
pub mod look;
pub mod screen;
pub mod seen;
pub mod texts;
pub mod viewing;

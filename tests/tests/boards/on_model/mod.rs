//! What only the model of the real board has: addresses of its own.

mod probe;

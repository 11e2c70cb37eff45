//! Properties of NURBS curves, and of what is done along them (mathematics 3).

mod along;
mod arc_length;
mod definitions;
mod shape;
mod validity;

//! Blocks that mean nothing, or nearly nothing: whether both refuse the same.

use super::writer::Writer;

const BLOCKS: [&str; 36] = [
    "G1 X1 X2",
    "G0 G1 X3",
    "G2 X10 Y10",
    "G2 X10 Y10 R0.001",
    "G3 X5 I1 J1 K1 R4",
    "G17 G2 X1 K3",
    "G93 G1 X4",
    "X#<never_set>",
    "X[1/0]",
    "X[SQRT[-1]]",
    "X[ASIN[2]]",
    "X[LN[0]]",
    "X[1+]",
    "X[[1]",
    "X1..2",
    "X--1",
    "XY1",
    "M3 M5",
    "G4",
    "G4 P-1",
    "M62",
    "M67 E1",
    "G10 L2 P12 X0",
    "G10 L2",
    "G43 H9999",
    "T-1",
    "F-5",
    "S-3",
    "G81 X1 Y1 Z1 R-5",
    "G83 X1 Z-2 R1",
    "G92",
    "G53 X1",
    "G91 G53 G0 X1",
    "M98",
    "o99 endif",
    "G55.1",
];

pub fn block(writer: &mut Writer) {
    let block = *writer.random.of(&BLOCKS);
    writer.line(block);
}

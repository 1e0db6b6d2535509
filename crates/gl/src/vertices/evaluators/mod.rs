//! Evaluators: polynomial maps, grids, and the vertices made from them.

mod evaluate;
mod maps;
mod mesh;

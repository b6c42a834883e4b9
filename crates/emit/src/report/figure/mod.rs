//! Figures of the report as SVG: axes, downsampled lines, density grids.

pub(crate) mod axis;
pub(crate) mod density_grid;
pub(crate) mod downsampling;
pub(crate) mod plot;

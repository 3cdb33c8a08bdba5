//! A cone map: for every place of a grid how wide a cone over it stays empty.

pub mod file;
pub mod generate;

/// What the cones of a map promise, and so which tracers may use them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum MapKind {
    /// Apex on a sample; no sample lies inside (Dummer 2006). Of the surface between the
    /// samples nothing is promised.
    Samples,
    /// As `Samples`, one cone per side: +x, -x, +y, -y.
    Quad,
    /// Apex on a sample; a ray from above through the cone should meet the surface at
    /// most once (Policarpo and Oliveira 2007).
    Relaxed,
    /// Apex over a cell; the cells that rise above it keep clear by an offset (the cone
    /// walk). Proven for the surface.
    Walk,
    /// As `Walk`, for rays that go down: only cells from which a ray can come out on
    /// the far side limit the cone.
    WalkRelaxed,
}

/// Widest ratio, in texels per whole height: a cone that nothing limits. Finite, so that
/// no arithmetic on it makes an infinity.
pub const WIDEST: f64 = 65_536.0;

/// Ratios of the cones over a grid.
#[derive(Clone, Debug, PartialEq)]
pub struct ConeMap {
    /// What the cones promise.
    pub kind: MapKind,
    /// Places along each axis: samples, or cells for the walks.
    pub size: [u32; 2],
    /// Which axes wrap.
    pub wrap: [bool; 2],
    /// Room that a walk's cones leave, in texels; 0 for the others.
    pub offset: f64,
    /// Horizontal distance in texels over difference in height (0..=1 being the whole
    /// relief), 0 to [`WIDEST`], row by row; a quad map has four after one another for
    /// each place.
    pub ratios: Vec<f64>,
}

impl ConeMap {
    /// Mean ratio.
    pub fn mean(&self) -> f64 {
        self.ratios.iter().sum::<f64>() / self.ratios.len() as f64
    }
}

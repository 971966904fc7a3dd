//! What floors are made of, and what lies on them.

/// A floor of a building that is cleaned by machines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FloorKind {
    /// Grey, cloudy, with pores.
    Concrete,
    /// Ceramic tiles of 30 cm with dark gaps.
    Tiles,
    /// Stone chips in cement, polished.
    Terrazzo,
    /// Sheet with fine flakes.
    Vinyl,
    /// Planks with grain.
    Wood,
    /// Poured resin, glossy, almost without texture.
    Epoxy,
}

impl FloorKind {
    /// Every kind.
    pub const ALL: [Self; 6] =
        [Self::Concrete, Self::Tiles, Self::Terrazzo, Self::Vinyl, Self::Wood, Self::Epoxy];

    /// The word for tables and file names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Concrete => "concrete",
            Self::Tiles => "tiles",
            Self::Terrazzo => "terrazzo",
            Self::Vinyl => "vinyl",
            Self::Wood => "wood",
            Self::Epoxy => "epoxy",
        }
    }
}

/// What was spilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirtKind {
    /// A puddle: darkens, tints and shines.
    Liquid,
    /// Flour, dust, sand: a thin, grainy veil.
    Powder,
    /// Loose particles of millimetres.
    Crumbs,
    /// Dried: a tint without gloss and without an edge.
    Stain,
}

impl DirtKind {
    /// Every kind.
    pub const ALL: [Self; 4] = [Self::Liquid, Self::Powder, Self::Crumbs, Self::Stain];

    /// The word for tables and file names.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Liquid => "liquid",
            Self::Powder => "powder",
            Self::Crumbs => "crumbs",
            Self::Stain => "stain",
        }
    }
}

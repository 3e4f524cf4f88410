//! A plot with its title and caption.

/// A plot with its title and caption.
pub struct Figure {
    /// What it shows.
    pub title: String,
    /// How to read it.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

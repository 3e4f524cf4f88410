//! Tiles as they are documented, made here, and what is refused.
#![cfg(test)]

mod geotiff;
mod hgt;
mod made;
mod refusals;
mod seams;

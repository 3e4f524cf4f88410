//! The fence of a plan as a tick reads it: [`fcc_core::flight::fence`].

use fcc_core::flight::fence;
use fcc_core::flight::path::LocalPlane;
use fcc_core::flight::route::Destination;
use nalgebra::Vector2;

use crate::item::Place;
use crate::plan::{Fence, Plan, Polygon};

/// A fence, to be kept for as long as it is watched.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Outline {
    zones: Vec<Zone>,
    floor_m: Option<f64>,
    ceiling_m: Option<f64>,
    back: Option<Destination>,
}

#[derive(Clone, PartialEq, Debug)]
struct Zone {
    plane: LocalPlane,
    inclusion: bool,
    shape: Shape,
}

#[derive(Clone, PartialEq, Debug)]
enum Shape {
    Circle(f64),
    Polygon(Vec<Vector2<f64>>),
}

impl Outline {
    pub(crate) fn of(plan: &Plan) -> Self {
        let Fence {
            polygons,
            circles,
            floor_m,
            ceiling_m,
            return_point,
        } = &plan.fence;
        let circles = circles.iter().map(|circle| Zone {
            plane: circle.centre.plane(),
            inclusion: circle.inclusion,
            shape: Shape::Circle(circle.radius_m),
        });
        let home_m = plan.home.map_or(0.0, |home| home.altitude_m);
        Self {
            zones: polygons.iter().filter_map(polygon).chain(circles).collect(),
            floor_m: *floor_m,
            ceiling_m: *ceiling_m,
            back: return_point.map(|(place, height_m)| Destination {
                at: place.plane(),
                altitude_m: home_m + height_m,
            }),
        }
    }

    /// Something about the fence.
    pub(crate) fn with<T>(&self, of: impl FnOnce(&fence::Fence<'_>) -> T) -> T {
        let zones: Vec<_> = self.zones.iter().map(Zone::borrowed).collect();
        of(&fence::Fence {
            zones: &zones,
            floor_m: self.floor_m,
            ceiling_m: self.ceiling_m,
        })
    }

    /// For the rest of the program, and where to return to from it.
    pub(crate) fn leak(self) -> (fence::Fence<'static>, Option<Destination>) {
        let zones: Vec<_> = self.zones.into_iter().map(Zone::leak).collect();
        let fence = fence::Fence {
            zones: zones.leak(),
            floor_m: self.floor_m,
            ceiling_m: self.ceiling_m,
        };
        (fence, self.back)
    }
}

fn polygon(polygon: &Polygon) -> Option<Zone> {
    let plane = polygon.corners.first()?.plane();
    let corner = |place: &Place| plane.origin_of_m(&place.plane());
    Some(Zone {
        plane,
        inclusion: polygon.inclusion,
        shape: Shape::Polygon(polygon.corners.iter().map(corner).collect()),
    })
}

impl Zone {
    fn borrowed(&self) -> fence::Zone<'_> {
        fence::Zone {
            plane: self.plane,
            inclusion: self.inclusion,
            shape: match &self.shape {
                Shape::Circle(radius_m) => fence::Shape::Circle {
                    radius_m: *radius_m,
                },
                Shape::Polygon(corners_m) => fence::Shape::Polygon { corners_m },
            },
        }
    }

    fn leak(self) -> fence::Zone<'static> {
        fence::Zone {
            plane: self.plane,
            inclusion: self.inclusion,
            shape: match self.shape {
                Shape::Circle(radius_m) => fence::Shape::Circle { radius_m },
                Shape::Polygon(corners_m) => fence::Shape::Polygon {
                    corners_m: corners_m.leak(),
                },
            },
        }
    }
}

//! The fence of a plan as a tick reads it: [`fcc_guidance::fence`].

use fcc_guidance::fence;
use fcc_guidance::path::LocalPlane;
use fcc_guidance::route::Destination;
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
    group: u16,
    shape: Shape,
}

#[derive(Clone, PartialEq, Debug)]
enum Shape {
    Circle(f64),
    Polygon(Vec<Vector2<f64>>),
}

impl Fence {
    /// Whether it permits a place, whatever the altitude.
    ///
    /// ```
    /// let text = "QGC WPL 110\n\
    ///     0 1 0 16 0 0 0 0 47.4 8.5 430 1\n\
    ///     1 0 0 5003 2000 0 0 0 47.4 8.5 0 1\n\
    ///     2 0 0 5003 2000 0 0 0 47.42 8.5 0 1\n";
    /// let permits = fcc_plan::read(text).unwrap().fence.permits();
    /// let at = |latitude_deg| fcc_plan::Place { latitude_deg, longitude_deg: 8.5 };
    /// assert!(permits(at(47.41)) && !permits(at(47.4)));
    /// ```
    pub fn permits(&self) -> impl Fn(Place) -> bool + 'static {
        let outline = Outline::around(self, 0.0, 0.0);
        move |place| {
            let (latitude_rad, longitude_rad) = place.radians();
            outline.with(|fence| {
                fence.clearance_m(latitude_rad, longitude_rad, Vector2::zeros()) >= 0.0
            })
        }
    }
}

impl Outline {
    /// Of a plan, with the usual height of a return above home, m.
    pub(crate) fn of(plan: &Plan, usual_m: f64) -> Self {
        let home_m = plan.home.map_or(0.0, |home| home.altitude_m);
        Self::around(&plan.fence, home_m, usual_m)
    }

    fn around(fence: &Fence, home_m: f64, usual_m: f64) -> Self {
        let Fence {
            polygons,
            circles,
            floor_m,
            ceiling_m,
            return_point,
        } = fence;
        let circles = circles.iter().map(|circle| Zone {
            plane: circle.centre.plane(),
            inclusion: circle.inclusion,
            group: circle.group,
            shape: Shape::Circle(circle.radius_m),
        });
        Self {
            zones: polygons.iter().filter_map(polygon).chain(circles).collect(),
            floor_m: *floor_m,
            ceiling_m: *ceiling_m,
            back: return_point.map(|(place, height_m)| Destination {
                at: place.plane(),
                altitude_m: home_m + if height_m == 0.0 { usual_m } else { height_m },
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
        group: polygon.group,
        shape: Shape::Polygon(polygon.corners.iter().map(corner).collect()),
    })
}

impl Zone {
    fn borrowed(&self) -> fence::Zone<'_> {
        fence::Zone {
            plane: self.plane,
            inclusion: self.inclusion,
            group: self.group,
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
            group: self.group,
            shape: match self.shape {
                Shape::Circle(radius_m) => fence::Shape::Circle { radius_m },
                Shape::Polygon(corners_m) => fence::Shape::Polygon {
                    corners_m: corners_m.leak(),
                },
            },
        }
    }
}

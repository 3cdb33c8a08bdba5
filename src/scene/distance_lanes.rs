//! Points, rays and cones of a [`Distance`] side by side, with the bits of single ones.

use std::array;

use glam::DVec3;

use crate::base::lanes::{LANES, Places};
use crate::base::outcome::Counts;
use crate::base::view::Beam;
use crate::formula::Reading;
use crate::scene::contract::{Advance, Hit, ROOMS, Step, Surface};
use crate::scene::distance::{CORNERS, Distance};
use crate::scene::distance_steps::{Ahead, Near, Walk};

impl Distance {
    /// The places of points of lanes, which are relative to the eye.
    fn places(&self, q: [Option<DVec3>; LANES]) -> Places {
        Places {
            points: q.map(|q| self.eye + q.unwrap_or(DVec3::ZERO)),
            on: q.map(|q| q.is_some()),
        }
    }

    /// The values of the field at points of lanes.
    fn values(&self, q: [Option<DVec3>; LANES]) -> [f64; LANES] {
        let values = self.evaluator.values(&self.places(q), self.iterations);
        array::from_fn(|i| {
            let reading = Reading {
                value: values[i],
                ..Reading::default()
            };
            let field = |q| self.read(q, reading, 0.0, &mut Counts::default());
            q[i].map_or(0.0, |q| field(q).0)
        })
    }

    /// See [`crate::scene::Solid::advance_lanes`].
    pub(super) fn advance_all(
        &self,
        cones: &[Beam; LANES],
        at: &mut [Advance; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) {
        let near: [Option<Near>; LANES] =
            array::from_fn(|i| on[i].then(|| self.near(&cones[i], at[i])));
        let tried = near.map(|near| near.and_then(|near| Some((near.q, near.trial?))));
        let places = self.places(tried.map(|tried| tried.map(|(q, _)| q)));
        let trial = tried.map(|tried| tried.map_or(0.0, |(_, trial)| trial));
        let balls = match self.stepping.proven {
            true => self.evaluator.balls(&places, self.iterations, &trial),
            false => self.evaluator.cones(&places, self.iterations, &trial),
        };
        for i in 0..LANES {
            if let Some(near) = &near[i] {
                let ball = places.on[i].then_some(balls[i]);
                at[i] = self.advance_by(&cones[i], at[i], near, ball, &mut work[i]);
            }
        }
    }

    /// See [`crate::scene::Solid::step_lanes`].
    pub(super) fn step_all(
        &self,
        rays: &[Beam; LANES],
        walks: &mut [Walk; LANES],
        on: [bool; LANES],
        work: &mut [Counts; LANES],
    ) -> [Step; LANES] {
        let ahead: [Option<Ahead>; LANES] = array::from_fn(|i| match on[i] {
            true => self.ahead(&rays[i], &walks[i]),
            false => None,
        });
        let of =
            |figure: fn(&Ahead) -> f64| array::from_fn(|i| ahead[i].as_ref().map_or(0.0, figure));
        let clear = of(|a| a.clear);
        let at = self.places(ahead.map(|a| a.map(|a| a.q)));
        let readings = match self.stepping.proven {
            true => self.evaluator.balls(&at, self.iterations, &of(|a| a.trial)),
            false => self.evaluator.steps(&at, self.iterations, &clear),
        };
        array::from_fn(|i| match &ahead[i] {
            None => Step::Out,
            Some(ahead) => {
                let reading = self.cleared(readings[i], ahead.clear);
                let field = self.read(ahead.q, reading, ahead.clear, &mut work[i]);
                self.go_on(&rays[i], &mut walks[i], ahead, field)
            }
        })
    }

    /// See [`crate::scene::Solid::rooms_lanes`].
    pub(super) fn rooms_all(
        &self,
        at: &Places,
        axes: &[DVec3; LANES],
        nearest: &[f64; LANES],
    ) -> [[f64; ROOMS]; LANES] {
        let mut rooms = [[0.0; ROOMS]; LANES];
        for nth in 0..ROOMS {
            let values = self.values(array::from_fn(|i| {
                let h = nearest[i] * f64::from(1 << nth);
                at.on[i].then(|| at.points[i] + h * axes[i])
            }));
            for (rooms, value) in rooms.iter_mut().zip(values) {
                rooms[nth] = value.max(0.0);
            }
        }
        rooms
    }

    /// See [`crate::scene::Solid::surfaces`].
    pub(super) fn surfaces_all(&self, hits: &[(Beam, Hit)]) -> Vec<Surface> {
        let values = CORNERS.map(|c| {
            self.values(array::from_fn(|i| {
                let (ray, hit) = hits.get(i)?;
                Some(ray.at(hit.t) + self.tap(ray, hit) * c)
            }))
        });
        let places = self.places(array::from_fn(|i| {
            hits.get(i).map(|(ray, hit)| ray.at(hit.t))
        }));
        let pigments = self.evaluator.trap_lanes(&places, self.iterations);
        let one = |(i, (ray, _)): (usize, &(Beam, Hit))| {
            Self::surface_of(ray, values.map(|v| v[i]), pigments[i])
        };
        hits.iter().enumerate().map(one).collect()
    }
}

//! One straight move in the space of all axes: how fast it may go, and how fast it may speed up.

use super::Drive;
use crate::machine::{AxisValues, MAX_AXES};

/// A move. Lengths along it are measured in seconds at full speed, all axes together: then no
/// weight between millimetres and degrees has to be made up.
#[derive(Debug, Clone, Copy)]
pub(super) struct Leg {
    /// How long it is [s]; 0 if no axis moves.
    pub(super) length: f64,
    /// Way of each axis per length.
    pub(super) direction: AxisValues,
    /// The least time it takes: by its pace or its slowest axis [s].
    pub(super) floor: f64,
    /// The axis that sets `floor`, unless its pace does.
    pub(super) slowest: Option<usize>,
    /// Greatest square of the speed that its axes have along it.
    pub(super) fastest: f64,
    /// Greatest square of the speed that its pace leaves.
    pub(super) top: f64,
    /// Greatest acceleration along it.
    pub(super) reach: f64,
    /// The axis that sets `reach`.
    pub(super) weakest: usize,
}

impl Leg {
    /// The move by `ways` in no less than `least` seconds.
    pub(super) fn new(ways: &[f64], least: f64, drives: &[Drive]) -> Self {
        let pairs = || ways.iter().zip(drives).take(MAX_AXES).enumerate();
        let length = pairs().map(|(_, (way, drive))| (way / drive.velocity).powi(2)).sum::<f64>();
        let length = length.sqrt();
        let mut leg = Self {
            length,
            direction: [0.0; MAX_AXES],
            floor: least,
            slowest: None,
            fastest: f64::INFINITY,
            top: 0.0,
            reach: f64::INFINITY,
            weakest: 0,
        };
        if !leg.moves() {
            return leg;
        }
        let mut quickest = 0.0;
        for (axis, (way, drive)) in pairs() {
            leg.direction[axis] = way / length;
            let seconds = way.abs() / drive.velocity;
            quickest = f64::max(quickest, seconds);
            if seconds > leg.floor {
                (leg.floor, leg.slowest) = (seconds, Some(axis));
            }
            let reach = drive.acceleration / leg.direction[axis].abs();
            if reach < leg.reach {
                (leg.reach, leg.weakest) = (reach, axis);
            }
        }
        // Even a pace of ages has a speed: a square of zero would never arrive.
        leg.top = (length / leg.floor).powi(2).max(f64::MIN_POSITIVE);
        leg.fastest = (length / quickest).powi(2);
        leg
    }

    /// False for a move that goes nowhere.
    pub(super) fn moves(&self) -> bool {
        0.0 < self.length
    }

    /// Time for a straight part of it, between two squares of speed, and the greatest square on
    /// the way: it speeds up, cruises and slows down.
    pub(super) fn straight(&self, length: f64, enter: f64, leave: f64) -> (f64, f64) {
        if length <= 0.0 {
            return (0.0, enter.max(leave));
        }
        let peak = (0.5 * (enter + leave) + self.reach * length).min(self.top);
        let peak = peak.max(enter).max(leave);
        let (from, top, to) = (enter.sqrt(), peak.sqrt(), leave.sqrt());
        let ramps = (2.0 * top - from - to) / self.reach;
        let ramped = (2.0 * peak - enter - leave) / (2.0 * self.reach);
        (ramps + (length - ramped).max(0.0) / top, peak)
    }
}

//! How long moves take on a machine: a planner that looks ahead, as controls have.
//!
//! Along a path with rounded [corners](super::corner) the speed is as high as everywhere the pace and
//! every axis' velocity and acceleration allow: first backwards, how fast one may be and still
//! slow down in time for all that comes; then forwards, how fast one gets. With `x` the square of
//! the speed the bounds are linear from one end of a piece to the other, and two passes give the
//! time-optimal motion (Pham and Pham, 2018, "A new approach to time-optimal path parameterization
//! based on reachability analysis").

use super::corner::Corner;
use super::leg::Leg;
use super::motion::{Limit, Motion, Timing};

/// Runs through `motion` from rest to rest as fast as it can be, and says how each move goes. A
/// move that goes nowhere takes no time.
pub fn time_motion(motion: &Motion) -> Vec<Timing> {
    let mut timings =
        vec![Timing { seconds: 0.0, pace: 0.0, limit: Limit::Least }; motion.least.len()];
    let planner = Planner::new(motion);
    if !planner.moving.is_empty() {
        let mut most = planner.backwards();
        let lowered = planner.look_ahead(&mut most);
        planner.forwards(&most, &lowered, &mut timings);
    }
    timings
}

/// Squares of speed come from sums and roots.
const ROUNDING: f64 = 1e-9;

struct Planner<'a> {
    motion: &'a Motion<'a>,
    /// The moves that go somewhere.
    moving: Vec<usize>,
}

/// Greatest squares of speed where the straight part of a move begins, where it ends, and in the
/// middle of the corner behind that.
type Ends = [f64; 3];

impl<'a> Planner<'a> {
    fn new(motion: &'a Motion<'a>) -> Self {
        let mut planner = Self { motion, moving: Vec::new() };
        let n_moves = motion.ways.len().checked_div(motion.drives.len()).unwrap_or(0);
        let n_moves = n_moves.min(motion.least.len());
        planner.moving = (0..n_moves).filter(|&i| planner.move_at(i).moves()).collect();
        planner
    }

    fn move_at(&self, i_move: usize) -> Leg {
        let Motion { drives, ways, least, .. } = self.motion;
        let ways = &ways[i_move * drives.len()..][..drives.len()];
        Leg::new(ways, least[i_move], drives)
    }

    fn leg(&self, i: usize) -> Leg {
        self.move_at(self.moving[i])
    }

    /// How fast each move may be run and still be slowed down in time.
    fn backwards(&self) -> Vec<Ends> {
        let mut most = vec![[0.0; 3]; self.moving.len()];
        self.slow_down(0, self.moving.len(), |i, ends| {
            most[i] = ends;
            true
        });
        most
    }

    /// Goes back from standing still at the end of move `end - 1` to move `start`, as long as
    /// `take` wants more.
    fn slow_down(&self, start: usize, end: usize, mut take: impl FnMut(usize, Ends) -> bool) {
        let drives = self.motion.drives;
        let mut leg = self.leg(end - 1);
        let mut before = 0.0;
        if end < self.moving.len() {
            before = Corner::new(&leg, &self.leg(end), drives).before;
        }
        let mut corner_most = 0.0;
        let mut out = leg.top.min(2.0 * leg.reach * before);
        for i in (start..end).rev() {
            let ahead = i.checked_sub(1).map(|i| self.leg(i));
            let corner = ahead.map(|ahead| (Corner::new(&ahead, &leg, drives), ahead));
            let after = corner.as_ref().map_or(0.0, |(corner, _)| corner.after);
            let straight = (leg.length - after - before).max(0.0);
            let enter = leg.top.min(out + 2.0 * leg.reach * straight);
            let goes_on = take(i, [enter, out, corner_most]);
            let (true, Some((corner, ahead))) = (goes_on, corner) else { return };
            [out, corner_most] = corner.most_before([ahead.top, leg.top], enter);
            (before, leg) = (corner.before, ahead);
        }
    }

    /// Lowers `most` to what a control dares that sees only some moves ahead, and tells for which
    /// moves, if for any.
    ///
    /// Of a long view a few moves, up to a thirty-second, are not counted on: then as many can be
    /// done at a time, and long programs stay linear in time however far the control sees.
    fn look_ahead(&self, most: &mut [Ends]) -> Vec<bool> {
        let seen = self.motion.look_ahead.map(|seen| seen.max(2));
        let Some(seen) = seen else { return Vec::new() };
        let n = most.len();
        let mut lowered = vec![false; n];
        let at_a_time = (seen / 32).max(1);
        for start in (0..n).step_by(at_a_time) {
            let end = start.saturating_add(seen).min(n);
            if end == n {
                // From here on it sees the end of it all.
                break;
            }
            self.slow_down(start, end, |i, ends| {
                let is_lower = ends[0] < most[i][0];
                if i < start + at_a_time {
                    (most[i], lowered[i]) = (ends, is_lower);
                }
                // Where nothing had to be given up nothing will be farther back.
                is_lower
            });
        }
        lowered
    }

    fn forwards(&self, most: &[Ends], lowered: &[bool], timings: &mut [Timing]) {
        let drives = self.motion.drives;
        let mut leg = self.leg(0);
        let mut enter = 0.0;
        // Of the corner before a move: length and time on it, square of speed in its middle, and who
        // worked hardest there.
        let (mut after, mut since, mut passed, mut worked) = (0.0, 0.0, 0.0, (0.0, leg.weakest));
        for (i, [most_in, most_out, most_corner]) in most.iter().enumerate() {
            let next = most.get(i + 1).map(|next| (self.leg(i + 1), next[0]));
            let corner = next.map(|(next, most)| (Corner::new(&leg, &next, drives), next, most));
            let before = corner.as_ref().map_or(0.0, |(corner, ..)| corner.before);
            let straight = (leg.length - after - before).max(0.0);
            let leave = (enter + 2.0 * leg.reach * straight).min(*most_out).min(leg.top);
            let (seconds, peak) = leg.straight(straight, enter, leave);
            let mut seconds = since + seconds;
            if straight > 0.0 {
                let ramp = (2.0 * peak - enter - leave) / (2.0 * leg.reach * straight);
                worked = harder(worked, (ramp.min(1.0), leg.weakest));
            }
            let mut ahead = (0.0, leg.weakest);
            let (mut reached, mut passes) = (enter, 0.0);
            if let Some((corner, _, most)) = &corner {
                [passes, reached] = corner.most_after(leave, [*most_corner, *most]);
                let [until, from] = corner.seconds([leave, passes, reached]);
                seconds += until;
                (after, since) = (corner.after, from);
                ahead = corner.hardest([leave, passes, reached]);
            }
            let peak = peak.max(passed).max(passes);
            let is_bound = (1.0 + ROUNDING) * enter >= *most_in || leave == *most_out;
            let is_blind = lowered.get(i) == Some(&true) && is_bound;
            let hardest = harder(worked, ahead).1;
            let limit = if is_blind { Limit::LookAhead } else { Limit::Acceleration(hardest) };
            timings[self.moving[i]] = timing(&leg, seconds, peak, limit);
            let Some((_, next, _)) = corner else { return };
            (leg, enter, passed, worked) = (next, reached, passes, ahead);
        }
    }
}

/// `limit` is what holds it if its own speeds do not.
fn timing(leg: &Leg, seconds: f64, peak: f64, limit: Limit) -> Timing {
    if peak * (1.0 + ROUNDING) < leg.top {
        return Timing { seconds, pace: leg.length / peak.sqrt(), limit };
    }
    // A long move at full speed may still spend much of its time on its ramps.
    let is_ramp = seconds > 1.01 * leg.floor;
    let own = leg.slowest.map_or(Limit::Least, Limit::Velocity);
    Timing { seconds, pace: leg.floor, limit: if is_ramp { limit } else { own } }
}

fn harder(one: (f64, usize), other: (f64, usize)) -> (f64, usize) {
    if other.0 > one.0 { other } else { one }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cam::schedule::Drive;

    /// 100 mm/s, 400 mm/s2: 12.5 mm to full speed.
    const DRIVE: Drive = Drive { velocity: 100.0, acceleration: 400.0, rounding: 0.01 };
    const ROUNDING_ERROR: f64 = 1e-9;

    fn timings(n_axes: usize, ways: &[f64], least: &[f64]) -> Vec<Timing> {
        time_motion(&Motion { drives: &vec![DRIVE; n_axes], ways, least, look_ahead: None })
    }

    fn total(timings: &[Timing]) -> f64 {
        timings.iter().map(|timing| timing.seconds).sum()
    }

    #[track_caller]
    fn assert_takes(seconds: f64, timings: &[Timing]) {
        let total = total(timings);
        assert!((total - seconds).abs() < ROUNDING_ERROR, "{total} s, not {seconds}");
    }

    #[test]
    fn a_long_move_is_a_trapezoid_and_a_short_one_a_triangle() {
        // L / v + v / a, and 2 sqrt(L / a).
        assert_takes(50.0 / 100.0 + 100.0 / 400.0, &timings(1, &[50.0], &[0.0]));
        assert_takes(2.0 * (16.0_f64 / 400.0).sqrt(), &timings(1, &[-16.0], &[0.0]));
        // At 20 mm/s only.
        let fed = timings(1, &[50.0], &[2.5]);
        assert_takes(2.5 + 20.0 / 400.0, &fed);
        assert_eq!((fed[0].pace, fed[0].limit), (2.5, Limit::Acceleration(0)));
    }

    #[test]
    fn moves_in_one_line_are_one_move() {
        let whole = total(&timings(2, &[30.0, 40.0], &[0.0]));
        let parts = [1.0, 10.0, 0.0, 0.001, 8.999, 20.0];
        let ways: Vec<f64> = parts.iter().flat_map(|part| [0.75 * part, part * 1.0]).collect();
        assert_takes(whole, &timings(2, &ways, &[0.0; 6]));
    }

    #[test]
    fn a_move_that_goes_nowhere_takes_no_time() {
        assert_eq!(total(&timings(1, &[0.0, 0.0], &[1.0, 1.0])), 0.0);
        assert_eq!(total(&timings(1, &[], &[])), 0.0);
        let timings = timings(1, &[0.0, 50.0, 0.0], &[9.0, 0.0, 9.0]);
        assert_takes(0.75, &timings);
        assert_eq!(timings[0].seconds, 0.0);
    }

    #[test]
    fn a_corner_is_rounded_at_the_speed_that_its_axes_and_its_rounding_allow() {
        // v^2 = 8 a delta: each axis goes from v to 0, or from 0 to v, over a parabola that begins
        // and ends 4 delta from the corner.
        let timings = timings(2, &[50.0, 0.0, 0.0, 50.0], &[0.0; 2]);
        let corner = 2.0 * 4.0 * 400.0 * 0.01_f64;
        let speed = corner.sqrt();
        let straight = 50.0 - 0.04;
        // Up to full speed, on, and down to the corner.
        let ramped = (1e4 + 1e4 - corner) / 800.0;
        let line = (200.0 - speed) / 400.0 + (straight - ramped) / 100.0;
        assert_takes(2.0 * (line + 0.04 / speed), &timings);
    }

    #[test]
    fn time_runs_backwards_as_fast() {
        let ways: Vec<f64> =
            (0..60).flat_map(|i| [0.5, 0.3 * f64::from(i * i % 17 - 8) / 8.0]).collect();
        let back: Vec<f64> = ways.chunks(2).rev().flatten().copied().collect();
        let forth = total(&timings(2, &ways, &[0.0; 60]));
        let back = total(&timings(2, &back, &[0.0; 60]));
        // Not exactly: a corner of this zigzag is one piece of one acceleration.
        assert!((forth - back).abs() < 5e-3 * forth, "{forth} s forth, {back} s back");
    }

    #[test]
    fn no_axis_is_faster_or_changes_its_speed_faster_than_it_can() {
        // A wavy path with noise, of uneven steps.
        let at = |i: usize| {
            let s = i as f64 * 0.4 + 0.15 * (i as f64 * 2.3).sin();
            [s, 6.0 * (s / 5.0).sin() + 0.004 * (i as f64 * 7.7).sin()]
        };
        let ways: Vec<[f64; 2]> = (0..500)
            .map(|i| {
                let (from, to) = (at(i), at(i + 1));
                [to[0] - from[0], to[1] - from[1]]
            })
            .collect();
        let timings = timings(2, ways.as_flattened(), &[0.0; 500]);
        let speed = |i: usize, axis: usize| ways[i][axis] / timings[i].seconds;
        let mut used: f64 = 0.0;
        for i in 1..499 {
            let between = 0.5 * (timings[i].seconds + timings[i + 1].seconds);
            for axis in 0..2 {
                assert!(speed(i, axis).abs() <= 100.0 * (1.0 + ROUNDING_ERROR));
                let change = (speed(i + 1, axis) - speed(i, axis)).abs() / between;
                used = used.max(change / 400.0);
            }
        }
        // Mean speeds of uneven moves lie beside their middles.
        assert!((0.95..1.1).contains(&used), "{used} of the acceleration");
    }

    #[test]
    fn a_slow_move_among_fast_ones_takes_its_time() {
        let ways: Vec<f64> =
            (0..99).flat_map(|i| [0.5, 0.1 * (f64::from(i) / 9.0).sin()]).collect();
        let mut least = [0.01; 99];
        least[50] = 0.1;
        let timings = timings(2, &ways, &least);
        // All but a fortieth, which its corners may be above its own speed.
        assert!(timings[50].seconds >= 0.1 * 0.975, "{:?}", timings[50]);
        let is_early = |(timing, least): (&Timing, &f64)| timing.seconds < 0.975 * least;
        assert!(!timings.iter().zip(&least).any(is_early));
    }

    #[test]
    fn a_program_of_the_paces_runs_just_as_fast() {
        let ways: Vec<f64> = (0..200)
            .flat_map(|i| [0.5, 0.4 * (f64::from(i) / 9.0).sin() + 0.02 * f64::from(i % 3)])
            .collect();
        let first = timings(2, &ways, &[0.004; 200]);
        let paces: Vec<f64> = first.iter().map(|timing| timing.pace).collect();
        let again = total(&timings(2, &ways, &paces));
        assert!((again / total(&first) - 1.0).abs() < 1e-3, "{again} s, {} s", total(&first));
    }

    #[test]
    fn a_control_that_sees_few_moves_runs_no_faster_than_it_can_stop() {
        let n = 4000;
        let (ways, least) = (vec![0.05; n], vec![0.0; n]);
        let drives = [DRIVE];
        let seeing = |look_ahead| {
            time_motion(&Motion { drives: &drives, ways: &ways, least: &least, look_ahead })
        };
        // v^2 = 2 a N L, the running move being one of the N.
        let timings = seeing(Some(16));
        let fastest = 0.05 / timings[n / 2].seconds;
        let bound = (2.0 * 400.0 * 16.0 * 0.05_f64).sqrt();
        assert!((0.9 * bound..bound).contains(&fastest), "{fastest} mm/s of {bound}");
        assert_eq!(timings[n / 2].limit, Limit::LookAhead);
        // 250 moves are 12.5 mm: what it takes from full speed.
        assert_takes(total(&seeing(None)), &seeing(Some(2000)));
        assert!(total(&seeing(Some(200))) > 1.01 * total(&seeing(None)));
    }

    #[test]
    fn an_axis_that_follows_another_as_the_second_spindle_of_a_pair_takes_no_time() {
        let at = |i: u32| (f64::from(i) * 0.7).sin() + 0.4 * (f64::from(i * i % 101) / 50.0);
        let alone: Vec<[f64; 2]> = (0..3000).map(|i| [0.5, 0.2 * at(i)]).collect();
        let pair: Vec<[f64; 3]> = alone.iter().map(|&[a, y]| [a, y, -a]).collect();
        let one = timings(2, alone.as_flattened(), &vec![0.0; 3000]);
        let both = timings(3, pair.as_flattened(), &vec![0.0; 3000]);
        // Nearly: with a third axis moves are longer, and not all alike.
        let (one, both) = (total(&one), total(&both));
        assert!((both / one - 1.0).abs() < 0.02, "{both} s, not {one}");
    }

    #[test]
    fn the_axis_that_cannot_follow_is_named() {
        let slow = Drive { acceleration: 20.0, ..DRIVE };
        let ways: Vec<f64> =
            (0..300).flat_map(|i| [0.5, 0.3 * (f64::from(i) / 12.0).sin()]).collect();
        let drives = [Drive { acceleration: 1e5, ..DRIVE }, slow];
        let timings = time_motion(&Motion {
            drives: &drives,
            ways: &ways,
            least: &[0.005; 300],
            look_ahead: None,
        });
        let by_second = timings.iter().filter(|t| t.limit == Limit::Acceleration(1)).count();
        assert!(by_second > 280, "{by_second}");
    }
}

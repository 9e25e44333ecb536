//! Counts in tests of the exact solution's work: a regression shows without a clock.

/// A piece of work.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Work {
    /// Fine steps of a line, as many as there are lanes, at once.
    Lanes,
    /// A step of its own, fine or long.
    Step,
    /// A turn of the pressure that is placed.
    Turn,
}

/// Counts a piece of work. Costs nothing outside tests.
#[inline(always)]
pub(crate) fn count(work: Work) {
    #[cfg(test)]
    counted::COUNTS.with_borrow_mut(|counts| counts[work as usize] += 1);
    #[cfg(not(test))]
    let _ = work;
}

#[cfg(test)]
mod counted {
    extern crate std;

    use core::cell::RefCell;

    use crate::motion::leg::Leg;
    use crate::port::Port;
    use crate::pump::pump::Pump;
    use crate::units::rad_s;

    std::thread_local! {
        pub(super) static COUNTS: RefCell<[u32; 3]> = const { RefCell::new([0; 3]) };
    }

    /// Returns the lanes, steps and turns of what `act` does.
    fn counts<T>(act: impl FnOnce() -> T) -> [u32; 3] {
        COUNTS.set([0; 3]);
        act();
        COUNTS.take()
    }

    /// The numbers are pinned, and a change of them needs a note here of the reason.
    ///
    /// A turn is placed only where it may be the highest or lowest pressure so far. When every turn was placed, there
    /// were 133, 37, 10 and 8.
    #[test]
    fn the_work_of_a_steady_state_is_what_its_edges_and_first_swings_need() {
        let pump = Pump::three_roller();
        let work = [5.0, 20.0, 100.0, 170.0].map(|rpm| counts(|| pump.steady_state(rad_s(rpm)).unwrap()));
        assert_eq!(work, [[246, 10, 10], [62, 8, 6], [14, 8, 6], [8, 9, 6]]);
    }

    #[test]
    fn the_work_of_a_runs_extremes_grows_with_its_edges() {
        let pump = Pump::three_roller();
        let run = |rpm, end_s| {
            let legs = [Leg::constant_speed(0.0, rad_s(rpm))];
            counts(|| crate::ExactRun::from_rest(&pump, Port::Outlet, legs).extremes(end_s))
        };
        assert_eq!(
            [run(100.0, 1.0), run(100.0, 10.0), run(10.0, 10.0)],
            [[35, 10, 3], [350, 100, 3], [310, 10, 2]]
        );
    }

    #[test]
    fn the_work_of_a_ripple_at_the_lines_end_is_that_of_its_fine_steps() {
        let pump = Pump::three_roller();
        let ripple = |rpm| counts(|| pump.constant_speed_outflow_ripple(rad_s(rpm)).unwrap());
        assert_eq!([ripple(20.0), ripple(100.0)], [[31, 4, 0], [7, 4, 0]]);
    }
}

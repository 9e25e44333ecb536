//! Claims about motions on boards that answer anything.

use proptest::prelude::*;

#[path = "../../fuzz/fuzz_targets/scripted_board.rs"]
mod scripted_board;

proptest! {
    #[test]
    fn whatever_a_board_answers_a_motion_ends_in_bounded_time_with_bounds_in_order(
        script in proptest::collection::vec(any::<u8>(), 1..600),
    ) {
        scripted_board::run_scripted(&script);
    }

    #[test]
    fn reports_and_answers_in_any_order_end_in_bounded_time_with_bounds_in_order(
        kind: u8,
        actions in proptest::collection::vec((0_u8..5, any::<u8>()), 1..400),
    ) {
        let actions = actions.into_iter().filter(|(action, _)| *action != 3);
        let script: Vec<u8> = std::iter::once(kind)
            .chain(actions.flat_map(|(action, value)| match action {
                1 => vec![action],
                _ => vec![action, value],
            }))
            .collect();
        scripted_board::run_scripted(&script);
    }
}

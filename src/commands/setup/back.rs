//! The way back to the previous question.

use pump_bench::setup::Topic;

use super::asker::Asked;
use super::course::{Course, tell_person};

/// Goes back from a question about the answers, or from their summary, to the previous question: its answer is
/// forgotten and suggested. The first question of a correction goes back to the summary, with the answers of before.
pub(super) fn to_question_before(course: &mut Course) -> Asked<()> {
    let before = |topic: &Topic| match course.at {
        Some(at) => *topic < at,
        None => *topic <= Topic::Rate,
    };
    let is_open = |topic: &Topic| course.kept.as_ref().is_none_or(|kept| !kept.contains(topic));
    let found = course.answers.asked.iter().rev().copied().find(|topic| before(topic) && is_open(topic));
    match found {
        Some(topic) => {
            if course.answers.done.written.is_some() && course.corrected.is_none() {
                // The file stays as it was done unless another answer comes.
                course.corrected = Some(course.answers.clone());
            }
            Ok(course.withdraw(topic)?)
        }
        None if course.kept.is_some() => {
            course.leave_correction();
            Ok(())
        }
        None => {
            tell_person("  no question was asked before this one");
            Ok(())
        }
    }
}

/// Goes back from a later step: to the previous question among the answers that this step asked anew, or else to their
/// summary.
pub(super) fn to_answers(course: &mut Course) -> Asked<()> {
    if course.at.is_some_and(|topic| topic <= Topic::Rate) {
        return to_question_before(course);
    }
    course.reviews = true;
    Ok(())
}

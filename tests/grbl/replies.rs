//! Claims about the replies of boards, read from bytes.

use proptest::prelude::*;
use pump_bench::drives::grbl_reply::{BoardState, Replies, Reply};

fn read(pieces: &[&[u8]]) -> Vec<Reply> {
    let (mut reader, mut replies) = (Replies::default(), Vec::new());
    for piece in pieces {
        reader.feed(piece, &mut replies);
    }
    replies
}

fn one(line: &str) -> Reply {
    let mut replies = read(&[line.as_bytes(), b"\r\n"]);
    assert_eq!(replies.len(), 1, "{line}: {replies:?}");
    replies.remove(0)
}

#[test]
fn every_kind_of_line_is_read() {
    assert_eq!(one("ok"), Reply::Ok);
    assert_eq!(one("error:9"), Reply::Error(9));
    assert_eq!(one("ALARM:1"), Reply::Alarm(1));
    assert_eq!(one("$100=250.000"), Reply::Setting { number: 100, value: 250.0 });
    assert_eq!(one("$1=25 (step idle delay, msec)"), Reply::Setting { number: 1, value: 25.0 });
    assert_eq!(one("[VER:1.1h.20190830:]"), Reply::Version("1.1h.20190830:".into()));
    assert_eq!(one("[PRB:1.5,0.000,-2:1]"), Reply::Probe { position: vec![1.5, 0.0, -2.0], found: true });
    assert!(matches!(one("Grbl 1.1h ['$' for help]"), Reply::Banner(_)));
    assert!(matches!(one("GrblHAL 1.1f ['$' or '$HELP' for help]"), Reply::Banner(_)));
    assert!(matches!(one("Grbl 3.7 [FluidNC v3.7.8 (wifi) '$' for help]"), Reply::Banner(_)));
    assert!(matches!(one("\u{1}x0Grbl 1.1f ['$' for help]"), Reply::Banner(_)));
    assert_eq!(one("[MSG:Grbl is fine]"), Reply::Message("MSG:Grbl is fine".into()));
    assert_eq!(one(">G54:ok"), Reply::Message(">G54:ok".into()));
    assert!(matches!(one("hello"), Reply::Unknown(_)));
    let Reply::Status(status) = one("<Hold:1|WPos:1.000,-2.5,0|Bf:15,128|FS:0,0|WCO:0.5,0,0>") else {
        panic!()
    };
    assert_eq!(status.state, BoardState::Hold { still: false });
    assert_eq!((status.machine, status.work), (None, Some(vec![1.0, -2.5, 0.0])));
    assert_eq!(status.offset, Some(vec![0.5, 0.0, 0.0]));
}

#[test]
fn damaged_reports_are_not_positions() {
    for line in [
        "<Idle|MPos:1.0,2.x,3>",
        "<Idle|MPos:1e9,0,0>",
        "<Idle|MPos:inf,0,0>",
        "<|MPos:1,2,3>",
        "<Idle|MPos:>",
    ] {
        assert!(matches!(one(line), Reply::Unknown(_)), "{line}");
    }
}

#[test]
fn reports_that_run_into_answers_are_told_apart() {
    let replies = read(&[b"ok<Idle|MPos:1.000,0.000,0.000>ok\n<Jo<Jog|MPos:2.0,0,0>\n"]);
    let states: Vec<_> = replies
        .iter()
        .map(|reply| match reply {
            Reply::Status(status) => format!("{:?}", status.state),
            other => format!("{other:?}"),
        })
        .collect();
    assert_eq!(states, ["Ok", "Idle", "Ok", "Unknown(\"<Jo\")", "Jog"]);
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic_and_however_they_are_divided(
        bytes in proptest::collection::vec(
            prop_oneof![
                any::<u8>(),
                proptest::sample::select(b"ok<>[]|:,.\n\r$=-0123MPosIdleGrbl /".to_vec())
            ],
            0..700,
        ),
        cuts in proptest::collection::vec(0_usize..700, 0..12),
    ) {
        let whole = read(&[&bytes]);
        let mut cuts: Vec<_> = cuts.into_iter().map(|cut| cut.min(bytes.len())).collect();
        cuts.extend([0, bytes.len()]);
        cuts.sort_unstable();
        let pieces: Vec<_> = cuts.windows(2).map(|ends| &bytes[ends[0]..ends[1]]).collect();
        prop_assert_eq!(read(&pieces), whole);
    }
}

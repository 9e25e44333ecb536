//! Links over good and bad lines.

use std::io;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use super::link::{Link, Place};
use super::peer::{Faults, PeerWire, Random, World};
use crate::drives::StopRequest;
use crate::drives::klipper::error::KlipperError;
use crate::drives::klipper::protocol::Format;
use crate::drives::wire::Wire;

const SECOND: Duration = Duration::from_secs(1);

fn link(world: World) -> (Link, Arc<Mutex<World>>) {
    link_that(world, StopRequest::default())
}

fn link_that(world: World, stop: StopRequest) -> (Link, Arc<Mutex<World>>) {
    let world = Arc::new(Mutex::new(world));
    let place = Place { port: "/dev/ttyACM0".into(), baud: 250_000 };
    (Link::new(Box::new(PeerWire(Arc::clone(&world))), place, stop), world)
}

fn good(next: u8) -> World {
    World::new(1, Faults::default(), Faults::default(), next)
}

/// Command of a number and some further bytes. The board answers it if it is a question.
fn command(number: u16, further: usize, is_question: bool) -> Vec<u8> {
    let body = [&number.to_be_bytes(), vec![0x7e; further].as_slice()].concat();
    [&[body.len() as u8 | if is_question { 0x40 } else { 0 }], body.as_slice()].concat()
}

fn numbers(done: &[Vec<u8>]) -> Vec<u16> {
    done.iter().map(|body| u16::from_be_bytes([body[0], body[1]])).collect()
}

#[test]
fn a_board_is_met_at_any_sequence_number() {
    for next in 0..16 {
        let (mut link, world) = link(good(next));
        link.connect(SECOND).unwrap();
        for number in 0..40 {
            link.queue(&command(number, 20, false)).unwrap();
        }
        link.settle().unwrap();
        assert_eq!(numbers(&world.lock().unwrap().board.done), (0..40).collect::<Vec<_>>(), "{next}");
    }
}

#[test]
fn commands_share_blocks_and_keep_to_the_window() {
    let (mut link, world) = link(good(0));
    link.connect(SECOND).unwrap();
    link.set_window(192);
    let blocks: Vec<u64> = (0..12).map(|number| link.queue(&command(number, 12, false)).unwrap()).collect();
    // A block holds three of these commands of 15 bytes.
    assert!(blocks.chunks(3).enumerate().all(|(n, chunk)| chunk.iter().all(|b| *b == blocks[0] + n as u64)));
    assert_eq!(link.queue_alone(&command(12, 0, false)).unwrap(), blocks[0] + 4);
    assert_eq!(link.queue(&command(13, 0, false)).unwrap(), blocks[0] + 5);
    link.turn(Duration::ZERO).unwrap();
    // Three blocks of 50 bytes are within 192, and a fourth is not.
    assert_eq!((link.under_way(), link.waiting()), (3, 3));
    link.settle().unwrap();
    assert_eq!(numbers(&world.lock().unwrap().board.done), (0..14).collect::<Vec<_>>());
    assert!(link.queue(&[0; 60]).is_err());
}

#[test]
fn an_answer_tells_when_its_question_was_carried_out() {
    let (mut link, world) = link(good(9));
    link.connect(SECOND).unwrap();
    link.queue(&command(1, 0, false)).unwrap();
    let asked = link.queue_alone(&command(2, 3, true)).unwrap();
    let later = link.queue(&command(3, 0, true)).unwrap();
    assert_eq!(link.sent_at(asked), None);
    let before = link.steady_now();
    link.turn(SECOND).unwrap();
    let answer = link.take().unwrap();
    assert_eq!(answer.content, command(2, 3, false)[1..]);
    let (from, to) = link.answered_within(asked, &answer).unwrap();
    assert!(before <= from && from < to && to == link.steady_now(), "{from:?} {to:?}");
    assert_eq!(link.answered_within(later, &answer), None);
    link.settle().unwrap();
    let second = link.take().unwrap();
    assert!(link.answered_within(later, &second).is_some() && link.take().is_none());
    assert_eq!(world.lock().unwrap().board.done.len(), 3);
}

#[test]
fn a_question_is_asked_until_it_is_answered() {
    const QUESTIONS: u8 = 20;
    // The board tells a command of two bytes back, if its number says so.
    let question = Format::new(0x42, "ask oid=%c value=%c").unwrap();
    let mut asked_anew = 0;
    for seed in 0..200 {
        let bad = Faults { byte: 3000, delay_us: 3000, ..Faults::default() };
        let (mut link, world) = link(World::new(seed, bad, bad, 3));
        link.connect(3 * SECOND).unwrap();
        for value in 0..QUESTIONS {
            let answered = link.ask(&question, &[7_u8.into(), value.into()], |_, _, arrival| {
                Ok((arrival.content == [7, value]).then_some(arrival.at))
            });
            assert!(answered.is_ok(), "{seed}: {answered:?}");
        }
        let mut done: Vec<_> = world.lock().unwrap().board.done.iter().map(|body| body[1]).collect();
        asked_anew += done.len() - usize::from(QUESTIONS);
        assert!(done.is_sorted(), "{seed}: {done:?}");
        done.dedup();
        assert!(done.into_iter().eq(0..QUESTIONS), "{seed}");
    }
    assert!(asked_anew > 50, "{asked_anew}");
}

#[test]
fn a_question_without_an_answer_is_an_error_by_its_deadline() {
    let (mut link, world) = link(good(0));
    link.connect(SECOND).unwrap();
    link.set_quiet(SECOND);
    let tell = Format::new(2, "tell oid=%c value=%c").unwrap();
    let asked = link.ask(&tell, &[7_u8.into(), 9_u8.into()], |_, _, _| Ok(None::<()>));
    let error = asked.unwrap_err().to_string();
    assert_eq!(error, "the board has not answered `tell` for 1.0 s; check its cable and power");
    assert_eq!(world.lock().unwrap().board.done.len(), 4);
}

#[test]
fn a_dictionary_is_read_over_a_bad_line() {
    let dictionary = include_bytes!("../dictionary/samples/board.zlib");
    for seed in 0..100 {
        let bad = Faults { byte: 1000, double: 20_000, delay_us: 2000, ..Faults::default() };
        let mut world = World::new(seed, bad, bad, (seed % 16) as u8);
        world.board.dictionary = dictionary.to_vec();
        let (mut link, _) = link(world);
        link.connect(3 * SECOND).unwrap();
        let dictionary = link.identify().unwrap();
        assert_eq!(dictionary.firmware_text(2), "Timer too close", "{seed}");
    }
}

#[test]
fn nothing_at_the_port_is_told() {
    let dead = Faults { dead_from_us: Some(0), ..Faults::default() };
    let (mut link, _) = link(World::new(1, dead, dead, 0));
    let error = link.connect(2 * SECOND).unwrap_err();
    assert_eq!(
        error.to_string(),
        "no board answers at /dev/ttyACM0 within 2 s at 250000 baud; check the port, the board's power, and \
         [drive] baud"
    );
}

#[test]
fn another_firmware_at_the_port_is_told() {
    let dead = Faults { dead_from_us: Some(0), ..Faults::default() };
    let mut world = World::new(1, dead, Faults::default(), 0);
    world.say(b"\r\nGrbl 1.1h ['$' for help]\r\n");
    let (mut link, _) = link(world);
    let error = link.connect(2 * SECOND).unwrap_err();
    assert_eq!(
        error.to_string(),
        "something answers at /dev/ttyACM0 with 28 bytes at 250000 baud, and they are no block of the Klipper \
         firmware; check the port, [drive] baud, and that the board runs this firmware"
    );
}

#[test]
fn a_board_that_was_reset_is_told() {
    let (mut link, world) = link(good(0));
    link.connect(SECOND).unwrap();
    link.set_quiet(SECOND);
    link.queue(&command(1, 0, false)).unwrap();
    link.settle().unwrap();
    world.lock().unwrap().board.next = 9;
    link.queue(&command(2, 0, false)).unwrap();
    let error = link.settle().unwrap_err();
    assert!(matches!(error, KlipperError::OutOfStep { told: 9, .. }), "{error}");
    // It is met anew, and what was queued before is not sent.
    link.connect(SECOND).unwrap();
    link.queue(&command(3, 0, false)).unwrap();
    link.settle().unwrap();
    assert_eq!(numbers(&world.lock().unwrap().board.done), [1, 3]);
}

#[test]
fn the_user_ends_a_wait_at_rest() {
    let dead = Faults { dead_from_us: Some(0), ..Faults::default() };
    let (mut link, world) = link_that(World::new(1, dead, dead, 0), StopRequest::new(|| true));
    assert!(matches!(link.connect(60 * SECOND), Err(KlipperError::Interrupted)));
    assert!(world.lock().unwrap().now_us < 100_000);
    link.queue(&command(1, 0, false)).unwrap();
    assert!(matches!(link.settle(), Err(KlipperError::Interrupted)));
}

#[test]
fn a_board_that_never_pauses_holds_nobody_up() {
    let (mut link, world) = link(good(0));
    link.connect(SECOND).unwrap();
    // 4 MB of confirmations of the block before.
    world.lock().unwrap().say(&[0x05, 0x15, 0xc9, 0x2c, 0x7e].repeat(1 << 14));
    link.queue(&command(1, 0, false)).unwrap();
    link.turn(Duration::ZERO).unwrap();
    assert!(world.lock().unwrap().now_us < 1_000_000);
}

/// Runs 40 commands over the line of a seed. Returns true if the board took all.
fn runs(seed: u64) -> bool {
    let mut random = Random(seed);
    let rate = [0, 300, 1000, 3000, 10_000][random.below(5) as usize];
    let dead = random.below(10) == 0;
    let faults = |random: &mut Random| Faults {
        byte: rate,
        double: [0, 10_000, 100_000][random.below(3) as usize],
        delay_us: [0, 500, 5000, 30_000][random.below(4) as usize],
        dead_from_us: dead.then(|| random.below(400_000)),
    };
    let (there, back) = (faults(&mut random), faults(&mut random));
    let (mut link, world) = link(World::new(random.next(), there, back, random.below(16) as u8));
    link.set_quiet(SECOND);
    let mut outcome = link.connect(2 * SECOND);
    link.set_window([64, 192, 1024][random.below(3) as usize]);
    let mut queued = 0;
    let mut answers = Vec::new();
    while outcome.is_ok() && (queued < 40 || link.waiting() + link.under_way() > 0) {
        for _ in 0..random.below(6).min(40 - queued) {
            let command = command(queued as u16, random.below(50) as usize, random.below(4) == 0);
            link.queue(&command).unwrap();
            queued += 1;
        }
        outcome = link.turn(Duration::from_millis(random.below(20)));
        answers.extend(std::iter::from_fn(|| link.take()));
    }
    let world = world.lock().unwrap();
    let done = numbers(&world.board.done);
    assert!(done.iter().copied().eq(0..done.len() as u16), "{seed}: {done:?}");
    assert!(answers.iter().all(|answer| {
        numbers(&world.board.done).contains(&u16::from_be_bytes([answer.content[0], answer.content[1]]))
    }));
    match outcome {
        Ok(()) => {
            assert_eq!(done.len(), 40, "{seed}");
            true
        }
        Err(
            KlipperError::Quiet { waited_s }
            | KlipperError::Garbled { waited_s, .. }
            | KlipperError::OutOfStep { waited_s, .. }
            | KlipperError::Silent { waited_s, .. },
        ) => {
            assert!(waited_s < 2.2, "{seed}: told after {waited_s} s");
            false
        }
        Err(error) => panic!("{seed}: {error}"),
    }
}

#[test]
fn every_command_arrives_once_and_in_order_or_the_link_is_lost_by_its_deadline() {
    const SEEDS: u64 = 10_000;
    let arrived = (0..SEEDS).filter(|seed| runs(*seed)).count() as u64;
    // A tenth of the lines dies on its way.
    assert!((SEEDS * 80 / 100..SEEDS * 97 / 100).contains(&arrived), "{arrived} of {SEEDS}");
}

/// Wire to a grbl board in a hold, which keeps what it was sent.
#[derive(Debug)]
struct HeldGrbl {
    sent: Arc<Mutex<Vec<u8>>>,
    report: &'static [u8],
    now: Duration,
}

impl Wire for HeldGrbl {
    fn read(&mut self, buffer: &mut [u8], wait: Duration) -> io::Result<usize> {
        self.now += wait;
        let count =
            if self.sent.lock().unwrap().is_empty() { 0 } else { self.report.len().min(buffer.len()) };
        buffer[..count].copy_from_slice(&self.report[..count]);
        self.report = &self.report[count..];
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sent.lock().unwrap().extend_from_slice(bytes);
        Ok(())
    }

    fn now(&mut self) -> Duration {
        self.now
    }

    fn sleep(&mut self, time: Duration) {
        self.now += time;
    }
}

#[test]
fn a_grbl_board_in_a_hold_gets_no_byte_that_lets_it_go_on() {
    for (report, is_grbl) in [
        (&b"<Hold:0|MPos:1.000,0.000,0.000|FS:0,0>\r\n"[..], true),
        (b"ok\r\n<Idle,MPos:0.000>", true),
        (b"<Ru", false),
        (b"\x05<a|~", false),
        (b"", false),
    ] {
        let sent = Arc::new(Mutex::new(Vec::new()));
        let wire = HeldGrbl { sent: Arc::clone(&sent), report, now: Duration::ZERO };
        let place = Place { port: "/dev/ttyACM0".into(), baud: 250_000 };
        let refused = Link::new(Box::new(wire), place, StopRequest::default()).refuse_grbl();
        assert_eq!(matches!(refused, Err(KlipperError::Foreign { .. })), is_grbl, "{refused:?}");
        assert_eq!(*sent.lock().unwrap(), b"?");
    }
}

//! The link between a program that plans doses and the board that makes their steps.
//!
//! The program is the *host*, the board the *node*. The host sends requests, and the node answers each of them.
//! Both ends are machines without I/O: bytes and times go in, bytes come out. Times of the host are in ns, times
//! of the node in ticks of its timer. The crate needs neither `std` nor an allocator.
//!
//! - [`message`]: the requests and answers.
//! - [`frame`]: COBS frames with a CRC-32 and a fixed header, which carry them.
//! - [`packing`]: segments in a few bytes each.
//! - [`receiver`]: the node's half: which segments are new, and when the host was last heard.
//! - [`sender`]: the host's half: the window, the clocks, the stream of segments, and the bracket of positions.
//! - [`timing`]: times in ticks and rates of steps, as both ends compute them.
//!
//! ```
//! use pump_link::frame::{Deframer, Encoded, RequestHeader, body};
//! use pump_link::message::Request;
//!
//! let header = RequestHeader { number: 7, session: 0x0123_4567_89ab_cdef };
//! let frame = Encoded::request(header, &Request::Status { axis: 2 })?;
//! let mut deframer = Deframer::new();
//! let (last, others) = frame.bytes().split_last().unwrap();
//! assert!(others.iter().all(|byte| deframer.push(*byte).is_none()));
//! let payload = deframer.push(*last).unwrap()?;
//! let (read, rest) = RequestHeader::split(payload)?;
//! assert_eq!((read, body::<Request>(rest)?), (header, Request::Status { axis: 2 }));
//! # Ok::<(), pump_link::frame::FrameError>(())
//! ```
#![cfg_attr(docsrs, feature(doc_cfg))]
#![no_std]
#![forbid(unsafe_code)]

pub mod frame;
pub mod message;
pub mod packing;
pub mod receiver;
pub mod sender;
pub mod timing;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;

//! Blocks that serve small allocations where the system has nothing left, to any thread.
//!
//! A block is cut into pieces whose sizes are powers of two. A piece that is freed goes to the next allocation of its
//! size. With the first piece as many addresses go back to the system. They are for Python's own objects, which cannot
//! be pieces.

use std::alloc::Layout;
use std::num::NonZero;
use std::ptr::{null_mut, with_exposed_provenance_mut};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::pages;

/// Size of a block, bytes. It takes room among addresses, and memory only where something is written.
pub(super) const SIZE: usize = 4 << 20;
/// Largest piece, bytes. A larger allocation grows with an input.
const LARGEST: usize = 256 << 10;
/// Smallest piece, bytes.
const SMALLEST: usize = 16;
/// Largest alignment of a piece, bytes.
const ALIGNED: usize = 64;
/// Number of the sizes of pieces.
const SIZES: usize = (LARGEST / SMALLEST).ilog2() as usize + 1;
/// Largest number of blocks that still hold pieces.
const BLOCKS: usize = 16;

/// A block, and its pieces.
#[derive(Clone, Copy)]
struct Block {
    start: NonZero<usize>,
    /// Bytes that were cut into pieces.
    cut: usize,
    /// Number of pieces in use.
    used: usize,
    /// First free piece of each size, which has the address of the next one in itself; 0 for none.
    free: [usize; SIZES],
}

impl Block {
    fn take() -> Option<Self> {
        Some(Self { start: pages::take(SIZE)?, cut: 0, used: 0, free: [0; SIZES] })
    }

    /// Returns the piece of a size, or none if the block is used up.
    fn piece(&mut self, size: usize) -> Option<usize> {
        let first = &mut self.free[number(size)];
        let piece = if *first != 0 {
            let piece = *first;
            #[allow(unsafe_code, reason = "a free piece holds the address of the next one")]
            let next = unsafe { with_exposed_provenance_mut::<usize>(piece).read() };
            *first = next;
            piece
        } else {
            let begin = self.cut.next_multiple_of(size.min(ALIGNED));
            self.cut = Some(begin + size).filter(|end| *end <= SIZE)?;
            self.start.get() + begin
        };
        self.used += 1;
        Some(piece)
    }

    fn has(&self, place: usize) -> bool {
        (self.start.get()..self.start.get() + SIZE).contains(&place)
    }

    fn free(&mut self, piece: usize, size: usize) {
        self.used -= 1;
        if self.used == 0 {
            (self.cut, self.free) = (0, [0; SIZES]);
            return;
        }
        let first = &mut self.free[number(size)];
        #[allow(unsafe_code, reason = "nobody else uses a free piece, and it has room for an address")]
        unsafe {
            with_exposed_provenance_mut::<usize>(piece).write(*first);
        }
        *first = piece;
    }
}

/// The reserve.
struct Heap {
    /// Blocks: the first is the reserve, the others hold pieces that are still in use.
    blocks: [Option<Block>; BLOCKS],
    /// Addresses of the size of a block, for the system.
    spare: Option<NonZero<usize>>,
}

static HEAP: Mutex<Heap> = Mutex::new(Heap { blocks: [None; BLOCKS], spare: None });

/// True while a piece may be in use. Until then no address is that of a piece. It is written while the heap is locked.
static IS_USED: AtomicBool = AtomicBool::new(false);

fn heap() -> MutexGuard<'static, Heap> {
    HEAP.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Returns the size of the piece for an allocation, or none if that is too large.
pub(super) fn size_of(layout: Layout) -> Option<usize> {
    if layout.size() > LARGEST || layout.align() > ALIGNED {
        return None;
    }
    Some(layout.size().max(layout.align()).max(SMALLEST).next_power_of_two())
}

/// Returns the number of a size of pieces.
fn number(size: usize) -> usize {
    (size / SMALLEST).ilog2() as usize
}

/// Returns a piece for an allocation; null if it is too large or no block has room.
pub(super) fn alloc(layout: Layout) -> *mut u8 {
    let Some(size) = size_of(layout) else { return null_mut() };
    let mut heap = heap();
    let Some(piece) = heap.blocks.iter_mut().flatten().find_map(|block| block.piece(size)) else {
        return null_mut();
    };
    IS_USED.store(true, Ordering::Relaxed);
    if let Some(spare) = heap.spare.take() {
        #[allow(unsafe_code, reason = "nobody has heard of these addresses, and they are taken out once")]
        unsafe {
            pages::give_back(spare, SIZE);
        }
    }
    with_exposed_provenance_mut(piece)
}

/// Tells if an address is that of a piece.
pub(super) fn owns(place: *mut u8) -> bool {
    IS_USED.load(Ordering::Relaxed) && heap().blocks.iter().flatten().any(|block| block.has(place.addr()))
}

/// Frees the piece of an allocation. Returns false if it is no piece.
pub(super) fn free(place: *mut u8, layout: Layout) -> bool {
    // Memory that a thread frees came to it from the thread that has stored this.
    if !IS_USED.load(Ordering::Relaxed) {
        return false;
    }
    let mut heap = heap();
    let Some(block) = heap.blocks.iter_mut().flatten().find(|block| block.has(place.addr())) else {
        return false;
    };
    if let Some(size) = size_of(layout) {
        block.free(place.addr(), size);
    }
    true
}

/// Makes the reserve whole: a block of which nothing is in use, and addresses for the system. Returns false if there is
/// no room for them.
pub(super) fn refill() -> bool {
    let mut heap = heap();
    for slot in &mut heap.blocks[1..] {
        if let Some(empty) = slot.take_if(|block| block.used == 0) {
            #[allow(unsafe_code, reason = "no piece of the block is in use, and it is taken out once")]
            unsafe {
                pages::give_back(empty.start, SIZE);
            }
        }
    }
    let is_whole = heap.blocks[0].is_some_and(|block| block.used == 0);
    if is_whole && heap.blocks.iter().skip(1).all(Option::is_none) {
        IS_USED.store(false, Ordering::Relaxed);
    }
    if !is_whole {
        let Some(old) = (1..BLOCKS).find(|place| heap.blocks[*place].is_none()) else { return false };
        let Some(block) = Block::take() else { return false };
        heap.blocks[old] = heap.blocks[0].replace(block);
    }
    heap.spare = heap.spare.or_else(|| pages::take(SIZE));
    heap.spare.is_some()
}

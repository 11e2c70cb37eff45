//! What fetching instructions waits for at most: flash behind the cache, and branches that were not foreseen.

use super::cycles::FLASH_WAIT;

/// Most half cycles that a line takes from flash: the rest of its four words of 64 bits comes behind the first, one in each period of
/// the AXI bus, at half the core's clock. That nothing runs until all are there is assumed.
const LINE_WAIT: u32 = FLASH_WAIT + 2 * 2 * 3;
/// Half cycles that are lost at a branch that was not foreseen: 8 cycles, 6 where the flags were set early (measured, as in
/// [`cycles`](super::cycles)).
const MISSED: u32 = 2 * 8;

/// Lines in the instruction cache: 32 kByte, two ways (PM0253, 4.7.5). That of two the older is replaced is assumed.
#[derive(Clone, Debug)]
pub struct InstructionCache {
    /// Numbers of the lines in each set, the newer first.
    sets: Vec<[u32; 2]>,
}

const LINE: u32 = 32;
const SETS: u32 = 512;
const EMPTY: u32 = u32::MAX;

impl Default for InstructionCache {
    fn default() -> Self {
        Self {
            sets: vec![[EMPTY; 2]; SETS as usize],
        }
    }
}

impl InstructionCache {
    /// Half cycles that `bytes` of instructions at `pc` in flash are waited for.
    pub fn fetch(&mut self, pc: u32, bytes: u32, is_on: bool) -> u32 {
        if !is_on {
            // By words of 64 bits.
            return (bytes / 8 + 1) * FLASH_WAIT;
        }
        let lines = pc / LINE..=(pc + bytes.max(1) - 1) / LINE;
        let missed = lines.filter(|line| !self.takes(*line)).count();
        missed as u32 * LINE_WAIT
    }

    /// Takes the line in; whether it had it.
    fn takes(&mut self, line: u32) -> bool {
        let set = &mut self.sets[(line % SETS) as usize];
        let had = set.contains(&line);
        if set[0] != line {
            *set = [line, set[0]];
        }
        had
    }
}

/// Where blocks went on to. Assumed: a table of 64 branches, each expected to do what it did last.
#[derive(Clone, Debug)]
pub struct Foresight {
    /// Ends of blocks, and what began after them.
    table: [(u32, u32); BRANCHES],
    /// End of the block that ran last.
    last: u32,
}

const BRANCHES: usize = 64;

impl Default for Foresight {
    fn default() -> Self {
        Self {
            table: [(0, 0); BRANCHES],
            last: 0,
        }
    }
}

impl Foresight {
    /// Half cycles that are lost as a block of `bytes` at `pc` begins.
    pub fn begin(&mut self, pc: u32, bytes: u32) -> u32 {
        let place = &mut self.table[(self.last / 2) as usize % BRANCHES];
        let was_foreseen = *place == (self.last, pc);
        *place = (self.last, pc);
        self.last = pc + bytes;
        if was_foreseen { 0 } else { MISSED }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_three_lines_in_one_set_the_oldest_is_fetched_again() {
        let mut cache = InstructionCache::default();
        let mut fetch = |line: u32| cache.fetch(0x0800_0000 + line * SETS * LINE + 4, 8, true);
        assert_eq!([0, 0, 1, 0].map(&mut fetch), [LINE_WAIT, 0, LINE_WAIT, 0]);
        assert_eq!([2, 0, 1].map(&mut fetch), [LINE_WAIT, 0, LINE_WAIT]);
    }

    #[test]
    fn a_block_waits_for_every_line_it_touches_and_for_every_word_without_the_cache() {
        let mut cache = InstructionCache::default();
        assert_eq!(cache.fetch(0x0800_001e, 4, true), 2 * LINE_WAIT);
        assert_eq!(cache.fetch(0x0800_001e, 4, false), FLASH_WAIT);
        assert_eq!(cache.fetch(0x0800_0000, 16, false), 3 * FLASH_WAIT);
    }

    #[test]
    fn a_branch_is_foreseen_once_it_did_the_same_before() {
        let mut foresight = Foresight::default();
        let lost: Vec<u32> = (0..4).map(|_| foresight.begin(0x0800_0100, 8)).collect();
        assert_eq!(lost, [MISSED, MISSED, 0, 0]);
        assert_eq!(foresight.begin(0x0800_0108, 8), MISSED);
    }
}

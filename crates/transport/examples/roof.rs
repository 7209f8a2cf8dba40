//! The roof under which the march works: how many values a second this machine fetches from random places.
//!
//!     cargo run --release -p tyndall-transport --example roof -- [--json FILE]
//!     cargo run --release -p tyndall-transport --features counters --example roof -- [--json FILE]
//!
//! Tables of 4-byte values, from one that fits the innermost cache to one that fits none, are read at places drawn by
//! linear congruential generators, in three ways: each place depends on the value before it, as when one path is
//! traced at a time; places do not depend on values, as in a pool of paths; the same with the processor's gather instructions.
//! On one core and on all, which share the table. Each figure is the best of three tries.
//!
//! Built with the feature `counters`, it then renders the benchmark's scenes of grids with the fast engine and tells
//! what share of the roof the march reaches (see `roof/share.rs`).

#[cfg(feature = "counters")]
#[path = "roof/share.rs"]
mod share;

use std::sync::Barrier;
use std::time::{Duration, Instant};

/// Places drawn at a time: one AVX2 register of indices, two of them in flight.
const LANES: usize = 16;

/// Times that many are read between two looks at the clock.
const ROUNDS: usize = 4096;

/// Multiplier and increment of the generators (Numerical Recipes, section 7.1).
const MULTIPLIER: u32 = 1_664_525;
const INCREMENT: u32 = 1_013_904_223;

/// How places are drawn and read.
#[derive(Clone, Copy, PartialEq)]
enum Way {
    Dependent,
    Independent,
    Gather,
}

/// One measurement.
struct Figure {
    bytes: usize,
    way: Way,
    threads: usize,
    /// Values a second, over all threads.
    rate: f64,
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let json = match &arguments[..] {
        [] => None,
        [option, file] if option == "--json" => Some(file.clone()),
        _ => {
            eprintln!("usage: roof [--json FILE]");
            std::process::exit(2);
        }
    };
    let figures = measure_all();
    print_table(&figures);
    #[cfg(feature = "counters")]
    let shares = share::measure_all(&|bytes, threads| roof(&figures, bytes, threads));
    #[cfg(not(feature = "counters"))]
    let shares: Vec<String> = Vec::new();
    if let Some(file) = json {
        let figures: Vec<String> = figures.iter().map(Figure::json).collect();
        let text = format!(
            "{{\n\"values_a_second\": [\n{}\n],\n\"march\": [\n{}\n]\n}}\n",
            figures.join(",\n"),
            shares.join(",\n")
        );
        if let Err(error) = std::fs::write(&file, text) {
            eprintln!("{file}: {error}");
            std::process::exit(1);
        }
    }
}

impl Way {
    const ALL: [Way; 3] = [Way::Dependent, Way::Independent, Way::Gather];

    fn name(self) -> &'static str {
        match self {
            Way::Dependent => "dependent",
            Way::Independent => "independent",
            Way::Gather => "gather",
        }
    }
}

impl Figure {
    fn json(&self) -> String {
        let (bytes, way, threads, rate) = (self.bytes, self.way.name(), self.threads, self.rate);
        format!(
            "{{\"bytes\": {bytes}, \"way\": \"{way}\", \"threads\": {threads}, \"values_a_second\": {rate:.4e}}}"
        )
    }
}

fn measure_all() -> Vec<Figure> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let ways: &[Way] = if has_gathers() { &Way::ALL } else { &Way::ALL[..2] };
    let mut figures = Vec::new();
    for bytes in (14..=28).step_by(2).map(|power| 1_usize << power) {
        let table: Vec<u32> = (0..(bytes / 4) as u32).map(|i| i.wrapping_mul(MULTIPLIER)).collect();
        for threads in if cores > 1 { vec![1, cores] } else { vec![1] } {
            for &way in ways {
                let tries = (0..3).map(|_| rate(&table, way, threads));
                figures.push(Figure { bytes, way, threads, rate: tries.fold(0.0, f64::max) });
            }
        }
    }
    figures
}

fn print_table(figures: &[Figure]) {
    println!("values from random places, millions a second");
    println!("table      threads  dependent  independent  gather");
    for row in figures.chunk_by(|a, b| (a.bytes, a.threads) == (b.bytes, b.threads)) {
        let rates: Vec<String> = row.iter().map(|figure| format!("{:9.0}", figure.rate / 1e6)).collect();
        println!("{:7} KiB  {:5}  {}", row[0].bytes / 1024, row[0].threads, rates.join("  "));
    }
}

/// The best rate at which independent values come from a table of `bytes`, between the sizes measured.
#[cfg(feature = "counters")]
fn roof(figures: &[Figure], bytes: usize, threads: usize) -> f64 {
    let best = |size: usize| {
        let of_size = figures.iter().filter(|figure| (figure.bytes, figure.threads) == (size, threads));
        of_size.map(|figure| figure.rate).fold(0.0, f64::max)
    };
    let size = |bytes: f64| (bytes.ln() / 4_f64.ln()).clamp(7.0, 14.0);
    let at = size(bytes as f64);
    let (low, high) = (at.floor(), at.ceil());
    let [a, b] = [low, high].map(|power| best(1 << (2 * power as u32)).ln());
    (a + (b - a) * (at - low)).exp()
}

/// Values a second that `threads` threads read together.
fn rate(table: &[u32], way: Way, threads: usize) -> f64 {
    let barrier = Barrier::new(threads);
    let work = |thread: usize| {
        let mut places = Places::new(thread as u32);
        barrier.wait();
        let (start, computed) = (Instant::now(), thread_seconds());
        let mut values = 0_u64;
        while start.elapsed() < Duration::from_millis(60) {
            places.read(table, way);
            values += (ROUNDS * LANES) as u64;
        }
        std::hint::black_box(places.sum);
        let computed = computed.zip(thread_seconds()).map(|(start, end)| end - start);
        values as f64 / computed.unwrap_or(start.elapsed().as_secs_f64())
    };
    std::thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|thread| scope.spawn(move || work(thread))).collect();
        let own = work(0);
        own + others.into_iter().map(|other| other.join().expect("reading does not panic")).sum::<f64>()
    })
}

/// Seconds that this thread has computed, which other work does not lengthen; where the system tells.
fn thread_seconds() -> Option<f64> {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    Some(text.split_whitespace().next()?.parse::<f64>().ok()? * 1e-9)
}

/// Generators of places, and the sum of what was read, without which nothing would be.
struct Places {
    states: [u32; LANES],
    sum: u32,
}

impl Places {
    fn new(seed: u32) -> Places {
        let states =
            std::array::from_fn(|lane| (seed * LANES as u32 + lane as u32).wrapping_mul(0x9e37_79b9));
        Places { states, sum: 0 }
    }

    /// Reads `ROUNDS` times `LANES` values.
    fn read(&mut self, table: &[u32], way: Way) {
        #[cfg(target_arch = "x86_64")]
        if has_gathers() {
            // SAFETY: the processor has AVX2, as just asked.
            #[allow(unsafe_code)]
            return unsafe { self.read_avx2(table, way) };
        }
        match way {
            Way::Dependent => self.read_dependent(table),
            Way::Independent | Way::Gather => self.read_independent(table),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn read_avx2(&mut self, table: &[u32], way: Way) {
        match way {
            Way::Dependent => self.read_dependent(table),
            Way::Independent => self.read_independent(table),
            Way::Gather => self.gather(table),
        }
    }

    #[inline(always)]
    fn read_dependent(&mut self, table: &[u32]) {
        // 64 bits, as a walk among 2^32 states would soon run in a circle.
        let mut state = u64::from(self.states[0]) << 32 | u64::from(self.states[1]);
        for _ in 0..ROUNDS * LANES {
            let place = (state >> 32) as usize >> shift(table);
            state = (state ^ u64::from(table[place & (table.len() - 1)]))
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
        }
        [self.states[0], self.states[1]] = [(state >> 32) as u32, state as u32];
        self.sum ^= state as u32;
    }

    #[inline(always)]
    fn read_independent(&mut self, table: &[u32]) {
        let shift = shift(table);
        let (mut states, mut sums) = (self.states, [0_u32; LANES]);
        for _ in 0..ROUNDS {
            let mut places = [0; LANES];
            for (state, place) in states.iter_mut().zip(&mut places) {
                *state = state.wrapping_mul(MULTIPLIER).wrapping_add(INCREMENT);
                *place = *state >> shift;
            }
            for (sum, place) in sums.iter_mut().zip(places) {
                *sum = sum.wrapping_add(table[place as usize & (table.len() - 1)]);
            }
        }
        self.states = states;
        self.sum ^= sums.iter().fold(0, |all, one| all ^ one);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2")]
    fn gather(&mut self, table: &[u32]) {
        use std::arch::x86_64::*;
        let shift = shift(table);
        assert!((u32::MAX >> shift) as usize == table.len() - 1);
        let [multiplier, increment] = [MULTIPLIER, INCREMENT].map(|number| _mm256_set1_epi32(number as i32));
        let shifts = _mm256_set1_epi32(shift as i32);
        let mut states: [__m256i; LANES / 8] = std::array::from_fn(|register| {
            let s = |lane: usize| self.states[8 * register + lane] as i32;
            _mm256_setr_epi32(s(0), s(1), s(2), s(3), s(4), s(5), s(6), s(7))
        });
        let mut sums = [_mm256_setzero_si256(); LANES / 8];
        for _ in 0..ROUNDS {
            for (state, sum) in states.iter_mut().zip(&mut sums) {
                *state = _mm256_add_epi32(_mm256_mullo_epi32(*state, multiplier), increment);
                let places = _mm256_srlv_epi32(*state, shifts);
                // SAFETY: no place is beyond u32::MAX >> shift, the table's last.
                #[allow(unsafe_code)]
                let values = unsafe { _mm256_i32gather_epi32::<4>(table.as_ptr().cast(), places) };
                *sum = _mm256_add_epi32(*sum, values);
            }
        }
        for (register, (state, sum)) in states.into_iter().zip(sums).enumerate() {
            let numbers = |register: __m256i| -> [u32; 8] {
                [
                    _mm256_extract_epi32::<0>(register) as u32,
                    _mm256_extract_epi32::<1>(register) as u32,
                    _mm256_extract_epi32::<2>(register) as u32,
                    _mm256_extract_epi32::<3>(register) as u32,
                    _mm256_extract_epi32::<4>(register) as u32,
                    _mm256_extract_epi32::<5>(register) as u32,
                    _mm256_extract_epi32::<6>(register) as u32,
                    _mm256_extract_epi32::<7>(register) as u32,
                ]
            };
            self.states[8 * register..][..8].copy_from_slice(&numbers(state));
            self.sum = numbers(sum).iter().fold(self.sum, |all, one| all ^ one);
        }
    }
}

/// By which a generator's state is shifted to be a place: its high bits are the random ones. Tables have 2^n values.
fn shift(table: &[u32]) -> u32 {
    u32::BITS - table.len().ilog2()
}

/// Whether there are gather instructions that this knows.
fn has_gathers() -> bool {
    #[cfg(target_arch = "x86_64")]
    return is_x86_feature_detected!("avx2");
    #[cfg(not(target_arch = "x86_64"))]
    false
}

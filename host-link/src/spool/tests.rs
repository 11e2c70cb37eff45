use super::*;

fn spooling(in_memory: usize) -> Spooling {
    Spooling {
        in_memory,
        ..Spooling::default()
    }
}

fn filled(in_memory: usize, records: u32) -> Spool<u32> {
    let mut spool = Spool::new(spooling(in_memory));
    (0..records).for_each(|record| spool.push(record));
    spool
}

#[test]
fn records_come_in_their_order_wherever_they_lie() {
    for in_memory in [0, 1, 2, 7, 100, 1000] {
        for records in [0, 1, 6, 7, 8, 100, 999] {
            let spool = filled(in_memory, records);
            assert!(
                spool.iter().eq(0..records),
                "{records} with {in_memory} in memory"
            );
            assert_eq!(spool.len(), u64::from(records));
            assert_eq!(spool.is_empty(), records == 0);
            assert_eq!(spool.check(), Ok(()));
            assert!(spool.in_memory + spool.newest.len() <= in_memory.max(1));
            assert_eq!(
                spool.file.is_some(),
                records as usize > in_memory.max(1) - 1 && in_memory < 1000
            );
        }
    }
}

#[test]
fn several_may_go_through_at_once_and_more_may_come_afterwards() {
    let mut spool = filled(3, 1000);
    let (mut one, mut other) = (spool.iter(), spool.iter().skip(500));
    for record in 0..500 {
        assert_eq!((one.next(), other.next()), (Some(record), Some(500 + record)));
    }
    assert_eq!(other.next(), None);
    drop((one, other));
    (1000..2000).for_each(|record| spool.push(record));
    assert!(spool.iter().eq(0..2000));
    assert!(spool == filled(5000, 2000) && spool != filled(3, 1999));
}

#[test]
fn numbers_come_back_to_the_bit() {
    let numbers = [
        0.0,
        -0.0,
        f64::NAN,
        f64::MIN_POSITIVE / 3.0,
        0.1 + 0.2,
        f64::INFINITY,
    ];
    let mut spool = Spool::new(spooling(1));
    numbers
        .iter()
        .for_each(|number| spool.push((*number, Some(*number as f32))));
    for ((long, short), number) in spool.iter().zip(numbers) {
        assert_eq!(long.to_bits(), number.to_bits());
        assert_eq!(short.unwrap().to_bits(), (number as f32).to_bits());
    }
}

#[test]
fn what_has_no_place_is_counted_and_the_rest_stays() {
    let mut spool = Spool::new(Spooling {
        folder: Some("/there/is/no/such/folder".into()),
        in_memory: 10,
        ..Spooling::default()
    });
    (0..100).for_each(|record: u32| spool.push(record));
    let error = spool.check().unwrap_err();
    assert_eq!(spool.len() + error.records, 100);
    assert_eq!(spool.iter().count() as u64, spool.len());
    assert!(error.records >= 90, "{error}");
    assert!(error.to_string().contains("records are lost: "), "{error}");
}

/// Batches come faster than the disk takes a record at a time.
#[test]
fn a_writer_that_may_wait_loses_nothing() {
    let mut writer = Writer::new(Spooling {
        in_memory: 1,
        waits: true,
        ..Spooling::default()
    });
    let batches = 300;
    for batch in 0..batches {
        writer.hand_over((100 * batch..100 * (batch + 1)).collect::<Vec<u32>>());
    }
    let spool = writer.finish([]);
    assert_eq!(spool.check(), Ok(()));
    assert!(spool.iter().eq(0..100 * batches));
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_loses_blocks_and_says_so() {
    let mut spool = filled(4, 10);
    let real = spool
        .file
        .replace(File::options().write(true).open("/dev/full").unwrap());
    (10..20).for_each(|record| spool.push(record));
    spool.file = real;
    (20..30).for_each(|record| spool.push(record));
    let error = spool.check().unwrap_err();
    assert!(error.reason.contains("No space left"), "{error}");
    assert_eq!((error.records, spool.len()), (12, 18));
    let kept: Vec<u32> = spool.iter().collect();
    assert_eq!(kept.len(), 18);
    assert!(kept.is_sorted() && kept.starts_with(&[0, 1, 2, 3, 4, 5, 6, 7]) && kept.ends_with(&[28, 29]));
}

#[test]
fn what_cannot_be_read_again_is_told() {
    let spool = filled(4, 20);
    spool.file.as_ref().unwrap().set_len(0).unwrap();
    let read = spool.iter().count() as u64;
    let error = spool.check().unwrap_err();
    assert!(read < 20 && read + error.records == 20, "{read}, {error}");
    assert_eq!((spool.iter().count() as u64, spool.check()), (read, Err(error)));
}

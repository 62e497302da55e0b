//! Every reader: nets, words, values.
#![no_main]

use burgeon::io;
use burgeon::language::expr::Type;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for parse in [io::bpt::parse, io::bv::parse, io::obj::parse_bspline] {
        for net in parse(bytes, true).into_iter().flatten() {
            assert_eq!(net.points.len(), burgeon::patch::net_points(net.degree));
        }
    }
    if let Ok(word) = io::json::parse(bytes) {
        word.validate().expect("what is read holds together");
        let mut written = Vec::new();
        io::json::write(&mut written, &word).expect("what is read is written");
        assert!(io::json::parse(&written).is_ok_and(|again| again == word));
    }
    for ty in [Type::Bool, Type::Int, Type::Float, Type::Vec3] {
        let _ = io::values::parse_csv(bytes, &ty);
        let _ = io::values::parse_json(bytes, &ty);
    }
});

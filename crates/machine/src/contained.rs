use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Once;

thread_local! {
    static CONTAINED: Cell<bool> = const { Cell::new(false) };
}

/// What `decode` gives, or `None` if it panics: where a library that decodes a file trips over damage, it must not take the
/// program along. That counts for this thread alone, so nothing in it may share its work with others.
///
/// The message of such a panic is not printed, since whoever calls says what is wrong with the file. Those of Tyndall's own code are: they are bugs.
pub fn contained<T>(decode: impl FnOnce() -> T) -> Option<T> {
    static HUSHED: Once = Once::new();
    HUSHED.call_once(|| {
        let told = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            // Sources of this workspace are named from its root.
            let is_ours = panic.location().is_none_or(|place| Path::new(place.file()).starts_with("crates"));
            if is_ours || !CONTAINED.get() {
                told(panic);
            }
        }));
    });
    let outer = CONTAINED.replace(true);
    let outcome = catch_unwind(AssertUnwindSafe(decode));
    CONTAINED.set(outer);
    outcome.ok()
}

#[cfg(test)]
mod tests {
    use super::contained;

    #[test]
    fn a_panic_ends_no_more_than_what_is_contained() {
        assert_eq!(contained(|| 3), Some(3));
        assert_eq!(contained(|| [1, 2][std::hint::black_box(2)]), None);
        assert_eq!(contained(|| contained(|| panic!("inside"))), Some(None::<()>));
    }
}

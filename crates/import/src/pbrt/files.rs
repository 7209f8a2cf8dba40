//! The files of a scene, one within another by `Include` and `Import`.

use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use tyndall_machine::{files, memory};

use super::context::Context;
use super::directives::Directive;
use super::place::Place;
use super::state::State;
use super::tokens::Tokens;
use super::world::World;
use crate::ImportError;
use crate::include_chain::include_chain;
use crate::packed::unpacked;

/// Files within files.
const DEEPEST: usize = 64;
/// Files in all.
const MOST_FILES: usize = 100_000;
/// Text in all, unpacked: memory is bounded where a file includes another many times or is packed densely.
const MOST_BYTES: u64 = 8 << 30;

/// Reads a scene file and all that it includes.
pub(super) fn read_world(path: &Path, context: &Context) -> Result<World, ImportError> {
    let mut files = Files { context, open: Vec::new(), count: 0, bytes: 0 };
    let mut state = State::new();
    let mut world = World::default();
    files.read(path, None, &mut state, &mut world)?;
    state.end()?;
    if !state.is_in_world() {
        return Err(ImportError::of(path, "has no `WorldBegin`: what is to be seen comes after it"));
    }
    Ok(world)
}

struct Files<'a> {
    context: &'a Context<'a>,
    /// The files that are being read, the innermost last.
    open: Vec<PathBuf>,
    count: usize,
    bytes: u64,
}

impl Files<'_> {
    fn read(
        &mut self,
        path: &Path,
        from: Option<&Place>,
        state: &mut State,
        world: &mut World,
    ) -> Result<(), ImportError> {
        let refuse = |message: String| match from {
            Some(place) => place.error(message),
            None => ImportError::of(path, message),
        };
        let shown = path.display();
        let key = path.canonicalize().unwrap_or_else(|_| path.to_path_buf());
        if let Some(chain) = include_chain(&self.open, &key) {
            return Err(refuse(format!("{chain}: the file includes itself; take one `Include` out")));
        }
        let bytes = self.content(path).map_err(|error| refuse(format!("{shown} cannot be read: {error}")))?;
        self.count += 1;
        self.bytes += bytes.len() as u64;
        if self.open.len() == DEEPEST || self.count > MOST_FILES || self.bytes > MOST_BYTES {
            let message =
                "more is included than is read: 64 files within each other, 100,000 files, or 8 GiB";
            return Err(refuse(message.to_owned()));
        }
        self.open.push(key);
        let mut tokens = Tokens::new(&bytes, Arc::from(path));
        while let Some((directive, place)) = Directive::read(&mut tokens)? {
            match directive {
                Directive::Include(name) => {
                    self.read(&self.context.path(&name), Some(&place), state, world)?;
                }
                Directive::Import(name) => {
                    // An imported file leaves no trace in the state.
                    let mut inner = state.clone();
                    self.read(&self.context.path(&name), Some(&place), &mut inner, world)?;
                    inner.end_of_import(state)?;
                }
                directive => state.apply(directive, &place, world, self.context)?,
            }
        }
        self.open.pop();
        Ok(())
    }

    fn content(&self, path: &Path) -> std::io::Result<Vec<u8>> {
        let left = MOST_BYTES + 1 - self.bytes;
        let mut file = files::open(path)?;
        let length = file.metadata()?.len();
        memory::ask(length, || format!("the {length} bytes of the file"))?;
        let mut bytes = Vec::new();
        (&mut file).take(left).read_to_end(&mut bytes)?;
        if bytes.starts_with(&[0x1f, 0x8b]) {
            let packed = std::mem::take(&mut bytes);
            unpacked(packed.as_slice(), packed.len() as u64).take(left).read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    }
}

//! A backend of which words outgrow the chunks.

use burgeon::language::Value;
use burgeon::plan::derive::{Backend, Outcome, StageId};
use burgeon::plan::step::Clock;
use burgeon::plan::{Content, Given, Plan};
use std::sync::Arc;

/// A backend whose chunks hold few modules, and that sees that none ever holds more.
pub struct Small<B> {
    pub inner: B,
    pub most: usize,
}

impl<B: Backend> Backend for Small<B> {
    type Chunk = B::Chunk;
    type Error = B::Error;

    fn plan(&self) -> &Arc<Plan> {
        self.inner.plan()
    }
    fn bind(&mut self, uniforms: &[Value], given: &Given) -> Result<(), B::Error> {
        self.inner.bind(uniforms, given)
    }
    fn upload(&mut self, content: Content) -> Result<B::Chunk, B::Error> {
        let chunk = self.inner.upload(content)?;
        assert!(self.len(&chunk) <= self.most);
        Ok(chunk)
    }
    fn read(&mut self, chunk: &B::Chunk) -> Result<Content, B::Error> {
        self.inner.read(chunk)
    }
    fn len(&self, chunk: &B::Chunk) -> usize {
        self.inner.len(chunk)
    }
    fn most_modules(&self) -> usize {
        self.most
    }
    fn split(&mut self, chunk: B::Chunk, most: usize) -> Result<Vec<B::Chunk>, B::Error> {
        let pieces = self.inner.split(chunk, most)?;
        assert!(pieces.iter().all(|p| (1..=most).contains(&self.inner.len(p))));
        Ok(pieces)
    }
    fn join(&mut self, chunks: Vec<B::Chunk>, ring: bool) -> Result<Vec<B::Chunk>, B::Error> {
        self.inner.join(chunks, ring)
    }
    fn recycle(&mut self, chunk: B::Chunk) {
        self.inner.recycle(chunk);
    }
    fn finish(&mut self) -> Result<(), B::Error> {
        self.inner.finish()
    }
    fn step(
        &mut self,
        stage: StageId,
        clock: Clock,
        chunk: &B::Chunk,
        room: u64,
    ) -> Result<Outcome<B::Chunk>, B::Error> {
        assert!(self.len(chunk) <= self.most);
        let outcome = self.inner.step(stage, clock, chunk, room)?;
        if let Outcome::Done { next, retired, .. } = &outcome {
            let chunks = next.iter().chain(retired.iter().map(|r| &r.0));
            chunks
                .for_each(|c| assert!((1..=self.most).contains(&self.inner.len(c)), "{}", self.inner.len(c)));
        }
        Ok(outcome)
    }
}

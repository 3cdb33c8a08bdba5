//! What comes back of a submission, and what is given back at the end.

use std::ops::RangeInclusive;
use std::sync::PoisonError;

use crate::gpu::collect::Parts;
use crate::gpu::error::RenderError;
use crate::gpu::staging::{Staging, Stagings};
use crate::gpu::stamps::STAMPS;
use crate::pass::layout::CellsHead;
use crate::pass::turn::{MOST_STAGES, StageKind, Turn};
use crate::picture::frame::Traffic;

use super::run::{Flight, REPORT, Run};

impl Run {
    /// The counts of the frame.
    pub(super) fn traffic_mut(&mut self) -> &mut Traffic {
        self.frame.traffic.get_or_insert_default()
    }

    /// Takes in what has ended.
    pub(super) fn receive(&mut self) -> Result<(), RenderError> {
        self.shared.device.check()?;
        let has_ended = |f: &Flight| {
            f.report.is_mapped() && f.reading.as_ref().is_none_or(|(_, s)| s.is_mapped())
        };
        let mut in_time = true;
        while self.flights.front().is_some_and(has_ended) {
            let Some(flight) = self.flights.pop_front() else {
                break;
            };
            self.land(flight, in_time)?;
            in_time = false;
        }
        Ok(())
    }

    /// Takes in a submission that has ended. It is in time if the host could submit after the one
    /// before had ended: in software Vulkan a submission waits for the one before, so that the
    /// host finds two of them ended at once.
    fn land(&mut self, flight: Flight, in_time: bool) -> Result<(), RenderError> {
        let shared = self.shared.clone();
        let device = &shared.device;
        let turn: Vec<Turn> = flight.report.read(device, 0, 1)?;
        let head: Vec<CellsHead> = flight.report.read(device, size_of::<Turn>(), 1)?;
        let (turn, head) = (turn[0], head[0]);
        let next = turn.next(head.moving);
        let count = flight.encoded as usize + 1;
        let at = (REPORT - STAMPS) as usize;
        let stamps: Vec<u64> = flight.report.read(device, at, count)?;
        self.reusable.stagings.put(flight.report);
        let now = (device.clock)();
        let elapsed_ms = now - flight.submitted.max(self.ended);
        self.ended = now;
        let last = flight.stages.start + flight.encoded - 1;
        self.count_time(flight.stages.start..=last, elapsed_ms, &stamps);
        self.learn(flight.stages.start..=last, elapsed_ms, &head);
        let share = if next == turn.number {
            turn.share()
        } else {
            0.0
        };
        self.share = match self.reached == next {
            true => self.share.max(share),
            false => share,
        };
        self.reached = next;
        if flight.stages.end.is_multiple_of(self.per_block()) {
            // Each block counts anew.
            self.told = [0; MOST_STAGES];
        }
        if let Some((block, staging)) = flight.reading {
            let is_next = self.job.completes(block) == Some(self.collected);
            if next >= (block as u32 + 1) * self.per_block() && is_next {
                self.collect(block, &staging, &head)?;
            }
            self.reusable.stagings.put(staging);
        }
        // What is left of a stage that is over need not be encoded, except at the end of a block,
        // where the results are read.
        let [reached, cursor] = [next, self.cursor].map(|stage| self.place(stage));
        if reached.0 == cursor.0 && reached.1 > cursor.1 {
            self.go_to(next);
        }
        // A submission from before a correction says nothing new.
        if next < flight.stages.end && flight.corrections == self.corrections {
            self.corrections += 1;
            // What is in flight may be for later stages, and visits nothing.
            let serves = |f: &Flight| {
                let first = f.stages.start;
                (first..first + f.encoded).contains(&next)
            };
            let drained = in_time && !self.flights.iter().any(serves);
            self.traffic_mut().drains += u32::from(drained);
            self.go_to(next);
            if next == turn.number && turn.begun == 1 {
                // And one for a further round.
                self.dispatches = turn.dispatches_left(head.moving) + 1;
            }
        }
        Ok(())
    }

    /// Adds the time of a submission to the figures of its passes: to each in proportion to its
    /// time on the device, or all to the last one if that is not measured.
    fn count_time(&mut self, stages: RangeInclusive<u32>, elapsed_ms: f64, stamps: &[u64]) {
        let timed = self
            .reusable
            .stamps
            .as_ref()
            .filter(|_| self.job.extras.time);
        let own = timed.map(|timed| timed.milliseconds(stamps));
        let own: Vec<f64> = own.unwrap_or_default();
        let all: f64 = own.iter().sum();
        let last = *stages.end();
        for (nth, stage) in stages.enumerate() {
            let at = self.pass_at(self.place(stage).1);
            let kind = StageKind::Pass(self.job.made.passes[at]);
            let begins = self.job.kinds.iter().position(|k| *k == kind);
            // A frame that keeps the colours only counts cells and tones.
            if begins.is_some_and(|begins| begins < self.from as usize) {
                continue;
            }
            let figures = &mut self.frame.passes[at];
            if let Some(ms) = own.get(nth) {
                *figures.gpu_ms.get_or_insert(0.0) += ms;
            }
            if all > 0.0 {
                figures.wall_ms += elapsed_ms * own[nth] / all;
            } else if stage == last {
                figures.wall_ms += elapsed_ms;
            }
        }
    }

    /// Learns from a submission how long dispatches take.
    fn learn(&mut self, stages: RangeInclusive<u32>, elapsed_ms: f64, head: &CellsHead) {
        let (block, first) = self.place(*stages.start());
        let (_, last) = self.place(*stages.end());
        let ran = |i: usize| head.dispatches[i].saturating_sub(self.told[i]);
        let all: u32 = (first..=last).map(ran).sum();
        let each = elapsed_ms / f64::from(all.max(1));
        let known = self.stages(block);
        let slice = self.slice();
        let costs = self
            .reusable
            .costs
            .iter_mut()
            .zip(known)
            .zip(head.dispatches);
        for (i, ((cost, stage), dispatches)) in costs.enumerate() {
            if (first..=last).contains(&i) && dispatches > self.told[i] {
                let ran = dispatches - self.told[i];
                cost.learn(each, [dispatches, ran], &stage, self.reusable.aim_ms);
            }
        }
        self.told = head.dispatches;
        self.follow_slice(slice);
    }

    fn collect(
        &mut self,
        block: usize,
        staging: &Staging,
        head: &CellsHead,
    ) -> Result<(), RenderError> {
        let device = &self.shared.device;
        if head.wrong > 0 {
            return Err(RenderError::Unwritten {
                device: device.info.name.clone(),
                cells: head.wrong as usize,
            });
        }
        let generation = self.generation(block);
        let layout = &self.job.made.blocks[block];
        let parts = Parts::new(layout, self.job.extras);
        parts.collect(
            device,
            staging,
            (layout, generation),
            (&self.job.made.passes, self.job.samples),
            &mut self.frame,
        )?;
        self.collected += 1;
        Ok(())
    }
}

impl Run {
    /// Gives up what was submitted. Its buffers serve again once the device has filled them.
    pub(super) fn discard_flights(&mut self, stagings: &mut Stagings) {
        for flight in self.flights.drain(..) {
            let reading = flight.reading.map(|(_, staging)| staging);
            stagings.discard(flight.report, reading);
        }
    }

    /// Leaves everything to the next render. The device may still run what was submitted; the
    /// next render is behind it.
    pub(super) fn lend(&mut self) {
        let mut reusable = std::mem::take(&mut self.reusable);
        self.discard_flights(&mut reusable.stagings);
        let shelf = self.shared.reusable.lock();
        *shelf.unwrap_or_else(PoisonError::into_inner) = reusable;
    }
}

impl Drop for Run {
    fn drop(&mut self) {
        // Another render may have taken it already.
        if self.reusable.target.is_some() {
            self.lend();
        }
    }
}

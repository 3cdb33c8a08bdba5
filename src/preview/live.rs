//! The open window: what it shows, and what it does in each turn of its loop.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::time::{Duration, Instant};

use glam::DVec3;
use winit::dpi::PhysicalPosition;
use winit::event::Modifiers;
use winit::keyboard::KeyCode;

use crate::picture::Layer;
use crate::plan::{Extras, Plan, march};
use crate::preview::actions::{NO_PASSES, passes};
use crate::preview::document::Document;
use crate::preview::error::PreviewError;
use crate::preview::flight::Flight;
use crate::preview::gui;
use crate::preview::input::{Drag, thrust};
use crate::preview::keep::Slot;
use crate::preview::leaving::Leaving;
use crate::preview::meter::{Figures, Meter};
use crate::preview::notice::{Ends, Notice};
use crate::preview::pictures::Pictures;
use crate::preview::play::Play;
use crate::preview::probe;
use crate::preview::question::Question;
use crate::preview::reload::{Watched, files_in, sources};
use crate::preview::screen::Shown;
use crate::preview::still::Still;
use crate::preview::views::ShownView;
use crate::preview::window::{Options, REST, Stage};
use crate::scene::Assets;

/// How long the loop sleeps while the device works, or the camera flies.
const BUSY: Duration = Duration::from_millis(1);
/// Time after which the panel follows what the device does.
pub const PANEL: Duration = Duration::from_millis(400);
/// The same while the film is played.
const PLAYING: Duration = Duration::from_millis(150);
/// The least time between two paintings of the panel, and while the camera moves: each costs pictures.
const PAUSE: Duration = Duration::from_millis(40);
const MOVING_PANEL: Duration = Duration::from_millis(1000);
/// Time after which the last picture is turned if no other came.
const TURN: Duration = Duration::from_millis(5);
/// The longest step of a flight in seconds: after a stall nobody wants to be elsewhere.
const LONGEST_STEP: f64 = 0.1;

/// What lies over the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visible {
    pub panel: bool,
    pub timeline: bool,
    pub help: bool,
    pub figures: bool,
}

/// The open window.
pub struct Live {
    pub pictures: Pictures,
    pub ctx: egui::Context,
    pub gui: egui_winit::State,
    pub document: Document,
    pub flight: Flight,
    pub play: Play,
    pub held: HashSet<KeyCode>,
    pub modifiers: Modifiers,
    pub cursor: PhysicalPosition<f64>,
    pub drag: Option<Drag>,
    pub clicked: Option<Instant>,
    pub shot: ShownView,
    /// What the picture on the screen shows.
    pub shows: Option<ShownView>,
    pub visible: Visible,
    /// What lies over the picture: x, y, width and height of each part in pixels.
    pub over: Vec<[u32; 4]>,
    /// The same of the panel and the timeline alone, which take every press of a button.
    pub panels: Vec<[u32; 4]>,
    /// Whether a field of text is left in the next painting of the panel.
    pub leaves_field: bool,
    /// Whether a value is dragged in the panel or the timeline.
    pub panel_drag: bool,
    /// Whether a number is typed there in a box of colours, whose digits are one step.
    pub panel_typing: bool,
    /// When the panel is painted again, and whether a user waits for that.
    pub panel_due: Option<Instant>,
    pub urgent: bool,
    pub redraw: bool,
    pub hidden: bool,
    pub closed: bool,
    /// What was asked for, and waits for a still or for the user to ask again.
    pub leaving: Option<Leaving>,
    /// Whether unsaved work could be kept so far.
    pub keeps: bool,
    /// Whether the last letter that was typed is Latin.
    pub of_latin: bool,
    /// What is told for a while, and errors that last.
    pub notice: Option<Notice>,
    pub standing: Vec<Notice>,
    /// What is wrong with a shader text, and whether its picture was tried again.
    pub shader_error: Option<(String, bool)>,
    pub still: Option<Still>,
    pub question: Option<Question>,
    /// Unsaved work of an earlier session with its slot, until it is taken or dropped.
    pub offered: Option<(u32, Plan)>,
    /// Where unsaved work of this session is kept: each work of the document has a place of its own.
    pub slots: HashMap<u32, Slot>,
    pub options: Options,
    pub meter: Meter,
    /// The wish of a picture that is not on the screen yet, and whether it is a full one.
    taken: Option<(u64, bool)>,
    /// When the window was drawn last, and the panel painted.
    drawn: Instant,
    painted: Instant,
    /// When the camera began to move, or when it rested last.
    rested: Instant,
    pub ticked: Instant,
    looked: Instant,
    pub preset_file: Watched,
    /// Whether it holds something that could not be read.
    pub unread: bool,
    pub shader_files: Watched,
    /// When the first change was made that is not kept yet.
    pub unkept: Option<Instant>,
    /// How often the device was opened again since the last full picture.
    pub losses: u32,
    /// Dropped last, as its surface is to go after all that knows its device.
    pub stage: Stage,
}

impl Live {
    /// A window that has just opened.
    pub fn new(stage: Stage, options: Options) -> Self {
        let ctx = gui::context();
        let device = stage.screen.device().clone();
        let most = device.device.limits().max_texture_dimension_2d as usize;
        let gui = egui_winit::State::new(
            ctx.clone(),
            egui::ViewportId::ROOT,
            &stage.window,
            Some(stage.window.scale_factor() as f32),
            None,
            Some(most),
        );
        let now = Instant::now();
        let preset = &options.preset;
        let mut pictures = Pictures::new(device);
        let watched = |folder: &PathBuf| Watched::new(files_in(folder));
        pictures.renderer.sources = options.wgsl.clone().map(sources);
        let document = Document::new(
            preset.name.clone(),
            options.path.clone(),
            preset.plan.clone(),
        );
        let mut live = Self {
            stage,
            pictures,
            ctx,
            gui,
            document,
            flight: Flight::default(),
            play: Play::default(),
            held: HashSet::new(),
            modifiers: Modifiers::default(),
            cursor: PhysicalPosition::default(),
            drag: None,
            clicked: None,
            shot: ShownView::Layer(Default::default()),
            shows: None,
            visible: Visible {
                panel: true,
                timeline: !preset.plan.tracks.is_empty(),
                ..Visible::default()
            },
            over: Vec::new(),
            panels: Vec::new(),
            leaves_field: false,
            panel_drag: false,
            panel_typing: false,
            panel_due: Some(now),
            urgent: true,
            redraw: true,
            hidden: false,
            closed: false,
            leaving: None,
            keeps: true,
            of_latin: true,
            notice: None,
            standing: Vec::new(),
            shader_error: None,
            still: None,
            question: None,
            offered: None,
            slots: HashMap::new(),
            meter: Meter::default(),
            taken: None,
            drawn: now,
            painted: now - MOVING_PANEL,
            rested: now,
            ticked: now,
            looked: now,
            preset_file: Watched::new(options.path.iter().cloned().collect()),
            unread: false,
            shader_files: options.wgsl.as_ref().map(watched).unwrap_or_default(),
            unkept: None,
            losses: 0,
            options,
        };
        live.offer();
        live.show_moment();
        live
    }

    /// Whether the window is to be closed.
    pub fn is_closed(&self) -> bool {
        self.closed
    }

    /// How quickly the window answered.
    pub fn figures(&self) -> Figures {
        self.meter.figures(self.pictures.traffic())
    }

    /// The plan that is shown: that of the document, over the window.
    pub fn shown(&self) -> Plan {
        Plan {
            size: self.stage.screen.size(),
            tracks: Vec::new(),
            ..self.document.plan.clone()
        }
    }

    /// The heights, maps and textures of the scene.
    pub fn assets(&self) -> &Assets {
        &self.pictures.assets
    }

    /// Does what is due, and returns how long it can sleep.
    ///
    /// # Errors
    /// The window or its device cannot go on.
    pub fn tick(&mut self) -> Result<Duration, PreviewError> {
        let now = Instant::now();
        let seconds = (now - self.ticked).as_secs_f64();
        self.ticked = now;
        if self.play.playing {
            self.play.advance(&self.document.plan, seconds);
            self.show_moment();
        }
        let flies = self.fly(seconds.min(LONGEST_STEP));
        if now - self.looked > REST {
            self.looked = now;
            self.look_at_files();
            self.keep_work();
        }
        if self.hidden {
            self.go_on_hidden()?;
            return Ok(if self.still.is_some() { BUSY } else { REST });
        }
        let moving = flies || self.play.playing || self.drag.is_some() || self.panel_drag;
        self.render(moving)?;
        self.end_notice(Ends::Later);
        let flies = flies || self.drag.is_some();
        if !flies {
            self.rested = now;
        }
        let free = match flies && !self.urgent {
            true => self.painted.max(self.rested) + MOVING_PANEL,
            false => self.painted + PAUSE,
        };
        let due = self.panel_due.map(|due| due.max(free));
        if due.is_some_and(|due| due <= now) {
            self.painted = now;
            self.paint();
        }
        if self.redraw {
            self.stage.window.request_redraw();
        }
        self.meter.turn(now);
        let asks = self.still.is_some() || self.question.is_some();
        let busy = moving || self.pictures.is_busy() || asks;
        Ok(match due {
            _ if busy => BUSY,
            Some(due) => due.saturating_duration_since(Instant::now()).min(REST),
            None => REST,
        })
    }

    /// Moves the camera. Returns whether it flies.
    fn fly(&mut self, seconds: f64) -> bool {
        let thrust = thrust(&self.held, self.modifiers.state().shift_key());
        let flies = thrust.way != DVec3::ZERO || thrust.roll != 0.0;
        if !flies {
            if self.drag.is_none() && !self.panel_drag && !self.panel_typing {
                self.document.end();
            }
            return false;
        }
        let plan = self.shown();
        // Heights that are still made leave nothing to hit.
        let far = plan.camera.eye.distance(plan.camera.target);
        let clearance = probe::clearance(&plan, self.assets()).unwrap_or(far);
        self.document.begin();
        let camera = &mut self.document.plan.camera;
        self.flight.step(camera, &thrust, clearance, seconds);
        true
    }

    /// Asks for the picture of the plan, and takes in what is finished.
    fn render(&mut self, moving: bool) -> Result<(), PreviewError> {
        self.answer_question();
        let mut plan = self.shown();
        // A discrete GPU marches cones only for who looks at them.
        let is_large = self.stage.screen.device().is_discrete();
        if is_large && self.shot.extras().levels && plan.march.may_drop_cones() {
            plan.march.coarsest = Some(march::COARSEST);
        }
        self.pictures.moving = moving;
        if let Err(fault) = plan.check() {
            return self.rest_on(&fault);
        }
        if let ShownView::Fronts(n) = self.shot
            && n >= passes(&plan, &self.pictures.assets)
        {
            self.shot = ShownView::Layer(Layer::Color);
            self.tell(NO_PASSES, false);
        }
        let extras = self.shot.extras();
        let figures = self.visible.figures;
        let is_plain = self.shot == ShownView::Layer(Layer::Color) && !figures;
        let kept = Extras {
            time: figures,
            count: figures || extras.count,
            unread: is_plain && plan.look.bloom == 0.0,
            ..extras
        };
        self.pictures.keep(kept, is_plain);
        let (before, wish) = (self.pictures.is_busy(), self.pictures.wish());
        self.pictures.want(&plan);
        if self.pictures.wish() != wish {
            self.meter.ask(self.pictures.wish());
        }
        match self.pictures.advance() {
            // Several views show the same layers.
            Ok(false) if self.shows == Some(self.shot) => {}
            Ok(_) => self.take(),
            Err(e) => self.failed(e)?,
        }
        if self.pictures.is_right() {
            self.end_notice(Ends::WithPicture);
        }
        // A still takes what pictures leave, and its share of a film that plays.
        if self.play.playing || !self.pictures.is_busy() {
            self.go_on_with_still();
        }
        if moving || before || self.pictures.is_busy() || self.still.is_some() {
            // The last picture turns with the camera, unless the next one comes soon.
            self.redraw |= moving && self.drawn.elapsed() > TURN;
            self.paint_soon(if self.play.playing { PLAYING } else { PANEL });
        }
        Ok(())
    }

    /// Takes in a finished picture.
    fn take(&mut self) {
        let Some(finished) = self.pictures.finished() else {
            return;
        };
        let view = finished.plan.view();
        match (self.shot, finished.texture) {
            (ShownView::Layer(Layer::Color), Some(texture)) if finished.plan.look.bloom == 0.0 => {
                self.stage.screen.hold(texture, view);
            }
            (shot, _) => {
                let bytes = shot.bytes(finished.frame, finished.plan);
                self.stage.screen.hold_pixels(&bytes, view);
            }
        }
        let (wish, is_full) = (finished.wish, finished.is_full);
        self.shows = Some(self.shot);
        self.taken = Some((wish, is_full));
        if is_full {
            self.losses = 0;
        }
        if let Some((_, tried)) = &mut self.shader_error {
            *tried = false;
        }
        self.redraw = true;
    }

    /// Draws the window.
    ///
    /// # Errors
    /// The surface is lost for good.
    pub fn draw(&mut self) -> Result<(), PreviewError> {
        if self.hidden || !self.stage.screen.works() {
            return Ok(());
        }
        let view = self.shown().view();
        let stage = &mut self.stage;
        match stage.screen.show(&stage.window, &view, &self.over)? {
            Shown::Yes => {
                self.redraw = false;
                self.drawn = Instant::now();
                self.meter.show(self.pictures.moving);
                if let Some((wish, is_full)) = self.taken.take() {
                    self.meter.answer(self.options.started, wish, is_full);
                }
            }
            Shown::Hidden => {}
            Shown::Again => self.redraw = true,
        }
        Ok(())
    }
}

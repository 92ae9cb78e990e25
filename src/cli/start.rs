//! A session as a command asks for it: a session file, and options over it.

use std::path::Path;
use std::sync::Arc;

use super::options::{FitArguments, MapArguments};
use crate::normal_map::procedural;
use crate::session::file::SessionFile;
use crate::session::{Session, measured, opening};

/// What a session starts from.
#[derive(Clone, Copy, Debug)]
pub struct Start<'a> {
    /// The map, a file or a bundled one by name; without it the session file's, or the bundled sample.
    pub map: Option<&'a Path>,
    /// How the map is read.
    pub map_arguments: &'a MapArguments,
    /// How it is fitted.
    pub fit: &'a FitArguments,
    /// A session file.
    pub session: Option<&'a Path>,
}

impl Start<'_> {
    /// A session of the map, with every setting in place, `change` the last of them, and no fit started.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn session(&self, change: impl FnOnce(&mut SessionFile) -> anyhow::Result<()>) -> anyhow::Result<Session> {
        let mut file = match self.session {
            Some(path) => SessionFile::read(path)?,
            None => SessionFile::default(),
        };
        let request = match self.map {
            Some(path) => Some(self.map_arguments.request(path, file.map_options.clone())),
            None => {
                file.map_options = self.map_arguments.over(file.map_options);
                file.map_request()
            }
        };
        let opened = match request {
            Some(request) => opening::read(&request).map_err(|message| anyhow::anyhow!(message.text))?,
            None => procedural::default_map().into(),
        };
        if let (Some(fit), None) = (&opened.fit, self.session) {
            file.fit = fit.settings;
        }
        file.fit = self.fit.over(file.fit);
        if let Some(path) = &file.measured {
            file.surface.material.measured = Some(measured::read(path)?);
        }
        change(&mut file)?;
        if let Some(sky) = file.sky.as_ref().filter(|_| file.surface.sky.environment.is_none()) {
            file.surface.sky.environment = Some(Arc::new(sky.load()?));
        }
        let mut session = Session::with_opened(opened, Arc::new(|| {}));
        session.set_threads(self.fit.threads());
        session.apply(&file);
        Ok(session)
    }
}

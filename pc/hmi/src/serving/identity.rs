//! The certificate that viewers see, and its key.

use crate::sockets::fingerprint;
use anyhow::{Context, bail};
use rustls::ServerConfig;
use rustls::crypto::ring;
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

/// Names of an own certificate and its key, beside the settings.
const OWN: [&str; 2] = ["viewers-certificate.pem", "viewers-key.pem"];
/// Name that an own certificate is for, besides the address.
const NAME: &str = "localhost";

/// See the module.
#[derive(Debug)]
pub struct Identity {
    /// The certificate, and those that it is signed by.
    chain: Vec<CertificateDer<'static>>,
    key: PrivateKeyDer<'static>,
}

impl Identity {
    /// Of PEM files.
    ///
    /// # Errors
    /// A sentence with the file.
    pub fn read(certificate: &Path, key: &Path) -> anyhow::Result<Self> {
        let cannot = |file: &Path| format!("cannot read {}", file.display());
        let chain: Result<Vec<_>, _> = CertificateDer::pem_file_iter(certificate)
            .with_context(|| cannot(certificate))?
            .collect();
        let chain = chain.with_context(|| cannot(certificate))?;
        if chain.is_empty() {
            bail!("{} has no certificate in PEM", certificate.display());
        }
        let key = PrivateKeyDer::from_pem_file(key).with_context(|| cannot(key))?;
        Ok(Self { chain, key })
    }

    /// A certificate signed by itself, made once for `address` and kept in `folder`; without a folder, made anew.
    ///
    /// # Errors
    /// A sentence with the file.
    pub fn own(folder: Option<&Path>, address: &str) -> anyhow::Result<Self> {
        let files = folder.map(|folder| OWN.map(|name| folder.join(name)));
        if let Some([certificate, key]) = &files
            && certificate.exists()
        {
            return Self::read(certificate, key);
        }
        let made = rcgen::generate_simple_self_signed([NAME.to_owned(), address.to_owned()])
            .context("cannot make a certificate")?;
        let key = made.signing_key.serialize_pem();
        if let Some([certificate, key_file]) = &files {
            // The certificate is what is looked for: it comes last.
            write(key_file, &key, true)?;
            write(certificate, &made.cert.pem(), false)?;
        }
        Ok(Self {
            chain: vec![made.cert.der().clone()],
            key: PrivateKeyDer::from_pem_slice(key.as_bytes()).context("cannot make a key")?,
        })
    }

    /// SHA-256 of the certificate, in hexadecimal digits.
    pub fn fingerprint(&self) -> String {
        self.chain.first().map_or(String::new(), fingerprint)
    }

    /// TLS with it.
    ///
    /// # Errors
    /// The key is not that of the certificate.
    pub(super) fn server(&self) -> anyhow::Result<Arc<ServerConfig>> {
        let config = ServerConfig::builder_with_provider(Arc::new(ring::default_provider()))
            .with_safe_default_protocol_versions()
            .and_then(|config| {
                config
                    .with_no_client_auth()
                    .with_single_cert(self.chain.clone(), self.key.clone_key())
            });
        Ok(Arc::new(config.context("the certificate cannot be used")?))
    }
}

/// Writes a file; one that `is_secret` is for its owner only.
fn write(file: &Path, text: &str, is_secret: bool) -> anyhow::Result<()> {
    let cannot = || format!("cannot write {}", file.display());
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder).with_context(cannot)?;
    }
    let mut options = OpenOptions::new();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, if is_secret { 0o600 } else { 0o644 });
    let mut opened = options
        .write(true)
        .create(true)
        .truncate(true)
        .open(file)
        .with_context(cannot)?;
    opened.write_all(text.as_bytes()).with_context(cannot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_own_certificate_is_made_once_and_its_key_is_for_its_owner_only() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("not there yet");
        let made = Identity::own(Some(&place), "127.0.0.1").unwrap();
        let again = Identity::own(Some(&place), "127.0.0.1").unwrap();
        assert_eq!(made.fingerprint(), again.fingerprint());
        assert_eq!(made.fingerprint().len(), 64);
        assert!(again.server().is_ok());
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            let mode = |name: &str| place.join(name).metadata().unwrap().permissions().mode() & 0o777;
            assert_eq!(mode(OWN[1]), 0o600);
        }
        let other = Identity::own(None, "127.0.0.1").unwrap();
        assert_ne!(made.fingerprint(), other.fingerprint());
    }

    #[test]
    fn what_is_no_certificate_is_told_with_its_file_and_another_key_refused() {
        let folder = tempfile::tempdir().unwrap();
        let [one, two] = ["one", "two"].map(|name| folder.path().join(name));
        Identity::own(Some(&one), "127.0.0.1").unwrap();
        Identity::own(Some(&two), "127.0.0.1").unwrap();
        let empty = folder.path().join("empty.pem");
        std::fs::write(&empty, "").unwrap();
        let said = Identity::read(&empty, &one.join(OWN[1])).unwrap_err().to_string();
        assert!(said.ends_with("empty.pem has no certificate in PEM"), "{said}");
        let said = Identity::read(&one.join(OWN[0]), &empty).unwrap_err().to_string();
        assert!(
            said.starts_with("cannot read") && said.ends_with("empty.pem"),
            "{said}"
        );
        let mixed = Identity::read(&one.join(OWN[0]), &two.join(OWN[1])).unwrap();
        assert!(mixed.server().is_err());
    }
}

#!/bin/sh
# Makes this machine ready for `cargo run --release` and `cargo test`.
#
# On Debian and Ubuntu it installs the packages that are missing, and nothing else. On any other system it says
# what is needed and changes nothing. Run it as often as you like.
#
# The window's libraries are opened at run time, so their development packages are not needed; cargo only wants
# something that compiles and links C. Keep the needs below in step with `plain_names`.
set -eu

oldest_cargo=1.95
# Administrators' folders are not on every user's path, yet some of the commands looked for live there.
PATH=$PATH:/usr/local/sbin:/usr/sbin:/sbin

scratch=
trap 'if [ -n "$scratch" ]; then rm -rf "$scratch"; fi' EXIT
trap 'exit 1' HUP INT TERM

plain_names() {
    cat <<'END'
setup: this is neither Debian nor Ubuntu, so nothing was changed. What is needed, by its plain name:
  to build: a C compiler and linker, with the C library's headers
  to draw: a Vulkan driver and loader; Mesa's software driver (lavapipe) will do
  for the window on Linux: libX11, libX11-xcb, libXcursor, libXi, libxkbcommon, libxkbcommon-x11, libwayland-client
  for the tests that drive a window: Xvfb, xauth, xdotool
END
}

# --- What is missing ---------------------------------------------------------------------------------------------

missing=

need() { missing="$missing $1"; }

has_command() { command -v "$1" >/dev/null 2>&1; }

has_package() {
    case $(dpkg-query -W -f '${db:Status-Status} ' "$1:$architecture" 2>/dev/null) in
        *not-installed*) return 1 ;;
        *installed*) return 0 ;;
        *) return 1 ;;
    esac
}

# Asks by doing: a compiler may be there without headers, or from elsewhere than a package.
can_build_c() {
    has_command cc || return 1
    printf '#include <stdio.h>\nint main(void) { return puts("ok") < 0; }\n' >"$scratch/probe.c"
    cc -o "$scratch/probe" "$scratch/probe.c" >/dev/null 2>&1
}

# Drivers announce themselves to the loader by a description in one of these folders.
has_vulkan_driver() {
    for description in "${VK_DRIVER_FILES:-}" "${VK_ICD_FILENAMES:-}" \
        /usr/share/vulkan/icd.d/*.json /usr/local/share/vulkan/icd.d/*.json \
        /etc/vulkan/icd.d/*.json /usr/local/etc/vulkan/icd.d/*.json; do
        [ -e "${description%%:*}" ] && return 0
    done
    return 1
}

list_missing() {
    architecture=$(dpkg --print-architecture)

    # rustc links through cc; a few dependencies compile a little C.
    if ! can_build_c; then
        need gcc
        need libc6-dev
    fi

    # Drawing, with a window or without.
    has_package libvulkan1 || need libvulkan1
    has_vulkan_driver || need mesa-vulkan-drivers

    # The window: X11 and keyboard, then Wayland.
    for library in libx11-6 libx11-xcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libwayland-client0; do
        has_package "$library" || need "$library"
    done

    # Tests that drive a real window on a screen of their own.
    has_command Xvfb || need xvfb
    has_command xauth || need xauth
    has_command xdotool || need xdotool
}

# --- Installing it -----------------------------------------------------------------------------------------------

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    else
        sudo "$@"
    fi
}

# apt asks nothing, waits for another apt to finish, and speaks only when it failed.
quiet_apt() {
    as_root env DEBIAN_FRONTEND=noninteractive NEEDRESTART_SUSPEND=1 \
        apt-get -o DPkg::Lock::Timeout=300 "$@" </dev/null >"$scratch/apt.log" 2>&1
}

install_missing() {
    if [ "$(id -u)" -ne 0 ] && ! has_command sudo; then
        echo "setup: some packages are missing and need root; as root, run: apt-get update && apt-get install -y --no-install-recommends$missing" >&2
        exit 1
    fi

    echo "setup: refreshing the list of packages"
    if ! quiet_apt update; then
        cat "$scratch/apt.log" >&2
        echo "setup: the list of packages could not be refreshed (see above); going on with the one at hand" >&2
    fi

    echo "setup: installing$missing"
    # One word a package, none with a blank in it.
    # shellcheck disable=SC2086
    if ! quiet_apt install -y --no-install-recommends $missing; then
        cat "$scratch/apt.log" >&2
        echo "setup: apt-get could not install$missing; its own words stand above, and setup can be run again once the cause is gone" >&2
        exit 1
    fi
}

# --- cargo -------------------------------------------------------------------------------------------------------

# Succeeds if version $1 is at least $2, both written major.minor with anything after.
at_least() {
    major=${1%%.*} minor=${1#*.} minor=${minor%%.*}
    wanted_major=${2%%.*} wanted_minor=${2#*.}
    [ "$major" -gt "$wanted_major" ] || { [ "$major" -eq "$wanted_major" ] && [ "$minor" -ge "$wanted_minor" ]; }
}

check_cargo() {
    if ! has_command cargo; then
        # Under sudo the path is root's; the user's own cargo does not show.
        [ -n "${SUDO_USER:-}" ] && return 0
        if [ -x "${HOME:-}/.cargo/bin/cargo" ]; then
            echo "setup: cargo is installed but not on the path; run: . \"\$HOME/.cargo/env\"" >&2
        else
            echo "setup: cargo is missing; get Rust $oldest_cargo or later from https://rustup.rs" >&2
        fi
        exit 1
    fi

    version=$(cargo --version 2>/dev/null | cut -d ' ' -f 2) || version=
    case $version in
        [0-9]*.[0-9]*) ;;
        *)
            echo "setup: cargo is there but does not say its version; with rustup, run: rustup default stable" >&2
            exit 1
            ;;
    esac
    if ! at_least "$version" "$oldest_cargo"; then
        echo "setup: cargo is $version and has to be $oldest_cargo or later; with rustup, run: rustup update stable (else see https://rustup.rs)" >&2
        exit 1
    fi
}

# -----------------------------------------------------------------------------------------------------------------

if has_command apt-get && has_command dpkg-query; then
    scratch=$(mktemp -d)
    list_missing
    if [ -n "$missing" ]; then
        install_missing
        echo "setup: done"
    else
        echo "setup: nothing to install"
    fi
else
    plain_names
fi
check_cargo

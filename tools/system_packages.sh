#!/usr/bin/env bash
# Installs what this machine lacks of the named groups of Debian packages.
# Usage: tools/system_packages.sh GROUP...    with GROUP one of venv, gl, browser
#
# Without root, or without apt-get, it says in one line what is missing and goes on: a person may
# have these things from elsewhere, and `sheath doctor` says whether rendering works.
set -euo pipefail

missing=()

# Debian keeps ldconfig off a plain user's PATH.
libraries=$(PATH="$PATH:/usr/sbin:/sbin" ldconfig -p 2>/dev/null || true)

# need_library NAME PACKAGE: PACKAGE is missing where the dynamic linker finds no NAME.
need_library() {
    [[ "$libraries" == *"$1"* ]] || missing+=("$2")
}

for group in "$@"; do
    case "$group" in
        venv)
            # Debian splits ensurepip, which the venv module needs, from Python.
            "${PYTHON:-python3}" -c 'import ensurepip' 2>/dev/null || missing+=(python3-venv)
            ;;
        gl)
            # EGL renders off screen, with no display; the driver does it on the CPU.
            need_library libEGL.so.1 libegl1
            need_library libOpenGL.so.0 libopengl0
            compgen -G '/usr/lib*/dri/*_dri.so' >/dev/null ||
                compgen -G '/usr/lib/*/dri/*_dri.so' >/dev/null || missing+=(libgl1-mesa-dri)
            # The fall-back (MUJOCO_GL=osmesa) comes along with a first install only: newer
            # Debians have it no more, and must not be asked for it at every run.
            [ ${#missing[@]} -eq 0 ] || need_library libOSMesa.so libosmesa6
            ;;
        browser)
            command -v chromium >/dev/null || missing+=(chromium)
            ;;
        *)
            echo "system_packages.sh: unknown group '$group'; known: venv, gl, browser" >&2
            exit 2
            ;;
    esac
done

if [ ${#missing[@]} -eq 0 ]; then
    exit 0
fi

if ! command -v apt-get >/dev/null; then
    echo "Missing: ${missing[*]} (Debian's names); install what your system calls them." >&2
elif [ "$(id -u)" -ne 0 ]; then
    echo "Missing: ${missing[*]}; install with: sudo apt-get install ${missing[*]}" >&2
else
    echo "Installing system packages: ${missing[*]}"
    export DEBIAN_FRONTEND=noninteractive
    apt-get update -qq || echo "apt-get update failed; trying with the lists at hand." >&2
    # One by one: a name that a release has dropped must not keep the others away.
    for package in "${missing[@]}"; do
        apt-get install -y -qq --no-install-recommends "$package" >/dev/null ||
            echo "Missing: $package, and apt-get could not install it (see above)." >&2
    done
fi

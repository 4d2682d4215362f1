# Sourced by ./demo and ./check: installs what is missing on Debian or Ubuntu, then configures and builds.
# Says what it installs, and asks for sudo only when it does not run as root.

sahel_packages=(
  g++ cmake ninja-build pkg-config ccache
  libglfw3-dev libepoxy-dev libgl-dev libegl-dev
  libgl1 libegl1 libgl1-mesa-dri libegl-mesa0 libglx-mesa0
  libglm-dev libopenexr-dev libimgui-dev libmeshoptimizer-dev libstb-dev libpng-dev
  libtbb-dev librandom123-dev nlohmann-json3-dev libcli11-dev libspdlog-dev libfmt-dev
  libsqlite3-dev libxxhash-dev libgdal-dev libbenchmark-dev ffmpeg
)
sahel_test_packages=(libgtest-dev libgmock-dev libfftw3-dev binutils xvfb xauth)

sahel_install() { # PACKAGE...
  if ! command -v dpkg-query >/dev/null 2>&1; then
    echo "This is not a Debian or Ubuntu machine: install what CMakeLists.txt asks for by hand." >&2
    return 0
  fi
  local missing=() package
  local have
  have=$(dpkg-query -W -f='${Status} ${Package}\n' "$@" 2>/dev/null | sed -n 's/^install ok installed //p')
  for package in "$@"; do
    grep -qx -- "$package" <<<"$have" || missing+=("$package")
  done
  [ ${#missing[@]} -eq 0 ] && return 0
  local as_root=()
  if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo)
    echo "These packages are missing and need sudo to install: ${missing[*]}"
    if ! command -v sudo >/dev/null 2>&1; then
      echo "There is no sudo here; as root: apt-get install ${missing[*]}" >&2
      return 1
    fi
  else
    echo "Installing missing packages: ${missing[*]}"
  fi
  local log status=0
  log=$(mktemp) || return 1
  "${as_root[@]}" apt-get update -qq || { rm -f "$log"; return 1; }
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
    >"$log" 2>&1 || { status=1; cat "$log" >&2; }
  rm -f "$log"
  return $status
}

sahel_configure() { # PRESET [CMAKE ARGUMENT...]
  local preset=$1
  shift
  [ -f "build/$preset/build.ninja" ] && [ $# -eq 0 ] && return 0 # ninja configures again by itself when it must
  local log status=0
  log=$(mktemp) || return 1
  cmake --preset "$preset" "$@" >"$log" 2>&1 || { status=1; cat "$log" >&2; }
  grep -E '^-- Sahel [0-9]' "$log"
  rm -f "$log"
  return $status
}

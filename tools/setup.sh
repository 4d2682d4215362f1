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
  else
    echo "Installing missing packages: ${missing[*]}"
  fi
  "${as_root[@]}" apt-get update -qq || return 1
  "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" \
    >/tmp/sahel-apt.$$ 2>&1 || { cat /tmp/sahel-apt.$$ >&2; rm -f /tmp/sahel-apt.$$; return 1; }
  rm -f /tmp/sahel-apt.$$
}

sahel_configure() { # PRESET [CMAKE ARGUMENT...]
  local preset=$1
  shift
  [ -f "build/$preset/build.ninja" ] && [ $# -eq 0 ] && return 0 # ninja configures again by itself when it must
  cmake --preset "$preset" "$@" >"/tmp/sahel-configure.$$" 2>&1 || {
    cat "/tmp/sahel-configure.$$" >&2
    rm -f "/tmp/sahel-configure.$$"
    return 1
  }
  tail -n 4 "/tmp/sahel-configure.$$" | head -n 1
  rm -f "/tmp/sahel-configure.$$"
}

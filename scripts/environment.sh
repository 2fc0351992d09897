# What scripts/test and scripts/demo share: finding Python, making environments, installing packages.
# To be sourced, from the repository root.

say() { printf '== %s\n' "$*"; }

fail() {
  printf '%s\n' "$*" >&2
  exit 1
}

# The first Python on the path that is new enough.
find_python() {
  local name
  for name in python3.13 python3.12 python3.11 python3; do
    if "$name" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
      command -v "$name"
      return
    fi
  done
  fail "basrelief needs Python 3.11 or newer, and none was found on the path; please install one."
}

# as_root COMMAND …: run it with the rights of root; false where they are not to be had.
as_root() {
  if [[ $(id -u) == 0 ]]; then
    "$@"
  else
    sudo -n "$@"
  fi
}

# debian_install PACKAGE …: false, quietly, where this is no Debian or we may not.
debian_install() {
  local install=(as_root env DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends)
  command -v apt-get && as_root true || return 1
  "${install[@]}" "$@" || { as_root apt-get update && "${install[@]}" "$@"; }
} </dev/null >/dev/null 2>&1

# make_environment FOLDER "WHAT IT DEPENDS ON" PIP-ARGUMENT …: a virtual environment with a package
# installed. One that is there is kept until a file that it depends on changes.
make_environment() {
  local folder=$1 files=$2 wanted python
  shift 2
  # shellcheck disable=SC2086
  wanted=$(pwd && find $files -type f ! -name '*.pyc' -exec cksum {} + | sort)
  [[ $(cat "$folder/made-from" 2>/dev/null) == "$wanted" ]] && return
  python=$(find_python)
  say "making $folder with $("$python" --version)"
  rm -rf "$folder"
  if ! "$python" -c 'import ensurepip' 2>/dev/null; then
    debian_install python3-venv || fail "$python cannot make environments; install python3-venv."
  fi
  "$python" -m venv "$folder"
  # most of what is installed is never imported: modules are compiled when they are
  "$folder/bin/python" -m pip install --quiet --no-compile --disable-pip-version-check "$@"
  printf '%s\n' "$wanted" >"$folder/made-from"
}

# make_node_modules: the tools for JavaScript that package.json names, in the versions of
# package-lock.json. Those that are there are kept until one of these files changes. False where
# Node.js or the tools cannot be installed.
make_node_modules() {
  local wanted
  if ! has_node && command -v apt-get >/dev/null; then
    say "installing nodejs and npm"
    debian_install nodejs npm || true
  fi
  has_node || return 1
  wanted=$(uname -sm && cksum package.json package-lock.json)
  [[ $(cat node_modules/made-from 2>/dev/null) == "$wanted" ]] && return
  say "making node_modules with Node.js $(node --version)"
  npm ci --no-audit --no-fund --loglevel error >/dev/null || return 1
  printf '%s\n' "$wanted" >node_modules/made-from
}

has_node() { command -v node && command -v npm; } >/dev/null

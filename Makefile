# The two commands, and the slower suites. Everything is done by tools/install_deps.sh and CMake.

JOBS ?= $(shell nproc 2>/dev/null || echo 2)

.PHONY: help program lab build python wheel wheel-all blender demo test scenes pictures videos study docs cluster asan asan-library tsan fuzz format clean

help:
	@echo "make demo    install what is missing, build, simulate the paper's scenes into out/"
	@echo "make lab     build weft-lab, which runs weft study and weft bench"
	@echo "make test    install what is missing, build, run all tests"
	@echo "make python  build the Python package: PYTHONPATH=build/release/python; for \$$WEFT_PYTHON, else python3"
	@echo "make wheel   dist/weft-*.whl and the source distribution, tried in an environment of their own"
	@echo "make wheel-all  a wheel for each of Python 3.10 to 3.13 that is there"
	@echo "make blender  the Blender extension from dist/ (after make wheel), and its tests in the newest Blender of PyPI"
	@echo "make scenes  the collision scenes at full size, every frame checked (a quarter of an hour)"
	@echo "make pictures  the pictures of README and docs, in docs/images"
	@echo "make videos  a video of every scene of contact/, in out/videos (ten minutes)"
	@echo "make study   every claim tested: docs/study/study.md again (most of an hour)"
	@echo "make docs    the site of docs/ and the C++ reference, in build/site"
	@echo "make cluster a farm on a real Slurm on this machine, a node of which dies and returns; as root (five minutes)"
	@echo "make asan    the tests under the address and undefined-behaviour sanitizers (half an hour)"
	@echo "make asan-library  the same of the libraries alone, without pictures, programs and Python: what CI runs"
	@echo "make tsan    the tests that use threads under the thread sanitizer (a quarter of an hour)"
	@echo "make fuzz    fuzz the readers of scenes, meshes, glTF and saved worlds, FUZZ_SECONDS each (default 60)"
	@echo "make format  clang-format"

# The program weft; with the laboratory weft-lab; with the Python package; everything.
targets_program = --target weft_app
targets_lab = --target weft_app --target weft_lab_app
targets_python = --target weft_app --target weft_python
program lab build python:
	@tools/install_deps.sh
	@cmake --preset release $(if $(filter build python,$@),$$(tools/make_venv.sh)) > /dev/null
	@cmake --build --preset release -j $(JOBS) $(targets_$@)

wheel: python
	@tools/make_wheel.sh build/venv/bin/python

wheel-all: python
	@tools/make_wheel.sh build/venv/bin/python $(foreach version,3.10 3.11 3.12 3.13,python$(version))

blender:
	@tools/install_deps.sh --blender
	@tools/make_blender.sh

demo: program
	@build/release/bin/weft demo

test: build
	@ctest --preset release

scenes: build
	@tools/check_scenes.sh build/release/bin/weft

pictures: program
	@tools/make_pictures.sh build/release/bin/weft docs/images

videos: program
	@tools/make_videos.sh build/release/bin/weft out/videos

study: lab
	@tools/make_study.sh build/release/bin/weft docs/study

docs:
	@tools/install_deps.sh --docs
	@mkdocs build --strict --quiet
	@mkdir -p build/site/cpp && doxygen Doxyfile
	@echo "build/site/index.html"

cluster: python
	@tools/install_deps.sh --cluster
	@tools/make_cluster.sh build/venv/bin/python build/release/python

# What CI runs of asan: the libraries but those of pictures, without programs and Python package.
asan-library:
	@tools/install_deps.sh
	@cmake --preset asan -DWEFT_BUILD_RENDER=OFF -DWEFT_BUILD_APP=OFF -DWEFT_BUILD_PYTHON=OFF > /dev/null
	@cmake --build --preset asan -j $(JOBS)
	@ctest --preset asan

asan tsan:
	@tools/install_deps.sh
	@cmake --preset $@ $(if $(filter asan,$@),$$(tools/make_venv.sh)) > /dev/null
	@cmake --build --preset $@ -j $(JOBS)
	@ctest --preset $@

fuzz:
	@tools/install_deps.sh --fuzz
	@tools/fuzz.sh $(or $(FUZZ_SECONDS),60)

format:
	@git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean:
	@rm -rf build out

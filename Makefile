# The two commands, and the slower suites. Everything is done by tools/install_deps.sh and CMake.

JOBS ?= $(shell nproc 2>/dev/null || echo 2)

.PHONY: help program lab build demo test scenes pictures videos study docs build asan tsan fuzz format clean

help:
	@echo "make demo    install what is missing, build, simulate the paper's scenes into out/"
	@echo "make lab     build weft-lab, which runs weft study and weft bench"
	@echo "make test    install what is missing, build, run all tests"
	@echo "make scenes  the collision scenes at full size, every frame checked (a quarter of an hour)"
	@echo "make pictures  the pictures of README and docs, in docs/images"
	@echo "make videos  a video of every scene of contact/, in out/videos (ten minutes)"
	@echo "make study   every claim tested: docs/study/study.md again (most of an hour)"
	@echo "make docs    the site of docs/ and the C++ reference, in build/site"
	@echo "make asan    the tests under the address and undefined-behaviour sanitizers (half an hour)"
	@echo "make tsan    the tests that use threads under the thread sanitizer (a quarter of an hour)"
	@echo "make fuzz    fuzz the readers of scenes, OBJ, .glb and saved worlds, FUZZ_SECONDS each (default 60)"
	@echo "make format  clang-format"

# The program weft; with the laboratory weft-lab; everything.
program lab build:
	@tools/install_deps.sh
	@cmake --preset release > /dev/null
	@cmake --build --preset release -j $(JOBS) $(if $(filter program,$@),--target weft_app) $(if $(filter lab,$@),--target weft_lab_app --target weft_app)

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

asan tsan:
	@tools/install_deps.sh
	@cmake --preset $@ > /dev/null
	@cmake --build --preset $@ -j $(JOBS)
	@ctest --preset $@

fuzz:
	@tools/install_deps.sh --fuzz
	@tools/fuzz.sh $(or $(FUZZ_SECONDS),60)

format:
	@git ls-files '*.h' '*.cpp' | xargs clang-format -i

clean:
	@rm -rf build out

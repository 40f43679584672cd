# docker build -t rigtri . && docker run --rm -v "$PWD:/work" -u "$(id -u)" rigtri check hero.glb
FROM python:3.13-slim AS build
WORKDIR /src
COPY . .
RUN python -m venv /opt/rigtri && /opt/rigtri/bin/pip install --no-cache-dir .

FROM python:3.13-slim
COPY --from=build /opt/rigtri /opt/rigtri
ENV PATH="/opt/rigtri/bin:$PATH"
RUN useradd --create-home --uid 1000 rigger
USER rigger
WORKDIR /work
ENTRYPOINT ["rigtri"]
CMD ["--help"]

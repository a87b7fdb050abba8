# An image for executors that run jobs in containers (docs/studies.md). No test builds it.
FROM python:3.11-slim
WORKDIR /opt/bearingwear
COPY pyproject.toml constraints.txt README.md LICENSE Snakefile ./
COPY bearingwear bearingwear
COPY kerneljit kerneljit
COPY config config
COPY profiles profiles
COPY workflow workflow
RUN pip install --no-cache-dir --no-compile -c constraints.txt .
ENV NUMBA_CACHE_DIR=/opt/numba
RUN bearingwear compile && chmod -R a+rwX /opt/numba
WORKDIR /study
CMD ["bearingwear", "--help"]

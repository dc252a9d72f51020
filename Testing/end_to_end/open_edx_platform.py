"""A learning platform: Open edX's own code of LTI 1.3 behind a web server, with one course.

    python open_edx_platform.py PORT FOLDER TOOL

runs in the environment of requirements/openedx.lock. Whatever Open edX says and checks in a launch
and for a grade is its own; only who is in the course, and how the gradebook is read, is made here.
"""

from __future__ import annotations

import sys
from pathlib import Path

import django
from django.conf import settings
from django.core.management import call_command
from django.http import HttpResponseRedirect, JsonResponse
from django.urls import include, path

PORT, FOLDER, TOOL = int(sys.argv[1]), Path(sys.argv[2]), sys.argv[3]
ADDRESS = f"http://localhost:{PORT}"
settings.configure(
    ALLOWED_HOSTS=["localhost"],
    DATABASES={
        "default": {"ENGINE": "django.db.backends.sqlite3", "NAME": str(FOLDER / "platform.db")}
    },
    DEFAULT_AUTO_FIELD="django.db.models.AutoField",
    INSTALLED_APPS=[
        "django.contrib.auth",
        "django.contrib.contenttypes",
        "config_models",
        "lti_consumer",
    ],
    LTI_API_BASE=ADDRESS,
    LTI_BASE=ADDRESS,
    PLATFORM_NAME="University",
    ROOT_URLCONF=__name__,
    SECRET_KEY="for tests",
    TEMPLATES=[
        {"BACKEND": "django.template.backends.django.DjangoTemplates", "APP_DIRS": True},
    ],
    USAGE_ID_PATTERN=r"(?P<usage_id>[^/]+)",
    USE_TZ=True,
)
django.setup()

from django.core.servers.basehttp import ThreadedWSGIServer, WSGIRequestHandler  # noqa: E402
from django.core.wsgi import get_wsgi_application  # noqa: E402
from lti_consumer.data import Lti1p3LaunchData  # noqa: E402
from lti_consumer.models import (  # noqa: E402
    Lti1p3Passport,
    LtiAgsLineItem,
    LtiAgsScore,
    LtiConfiguration,
)

API = f"{ADDRESS}/api/lti_consumer/v1"


def course() -> LtiConfiguration:
    """Return the course's link to the tool; it is made when the platform starts first."""
    found = LtiConfiguration.objects.first()
    if found is not None:
        return found
    passport = Lti1p3Passport.objects.create(name="tool", lti_1p3_tool_keyset_url=f"{TOOL}/jwks")
    made = LtiConfiguration.objects.create(
        version=LtiConfiguration.LTI_1P3,
        config_store=LtiConfiguration.CONFIG_ON_DB,
        lti_1p3_passport=passport,
        lti_1p3_oidc_url=f"{TOOL}/login",
        lti_1p3_launch_url=f"{TOOL}/launch",
    )
    LtiAgsLineItem.objects.create(
        lti_configuration=made, resource_id="task-1", score_maximum=100, label="Task 1"
    )
    return made


def registration(_request):
    """The required settings of the tool."""
    found = course()
    passport = found.lti_1p3_passport
    return JsonResponse(
        {
            "name": settings.PLATFORM_NAME,
            "issuer": ADDRESS,
            "clientId": passport.lti_1p3_client_id,
            "deploymentIds": ["1"],
            "authenticationUrl": f"{API}/launch/",
            "tokenUrl": f"{API}/token/{passport.passport_id}",
            "keySetUrl": f"{API}/public_keysets/{passport.passport_id}",
        }
    )


def open_link(_request, user, role):
    """Begin a launch, as a click on the link in the course does."""
    found = course()
    data = Lti1p3LaunchData(
        user_id=user,
        user_role=role,
        config_id=str(found.config_id),
        resource_link_id="link-1",
        name="Jo Doe",
        email="jo@example.org",
        custom_parameters={"task": "task-1", "mode": "desktop"},
        launch_presentation_document_target="window",
    )
    return HttpResponseRedirect(found.get_lti_consumer().prepare_preflight_url(data))


def gradebook(_request):
    """All grades that the platform has accepted, by user."""
    scores = LtiAgsScore.objects.all()
    return JsonResponse(
        {each.user_id: [each.score_given, each.grading_progress] for each in scores}
    )


class QuietHandler(WSGIRequestHandler):
    def log_message(self, *_arguments):
        pass


urlpatterns = [
    path("api/", include("lti_consumer.plugin.urls")),
    path("registration", registration),
    path("open/<user>/<role>", open_link),
    path("gradebook", gradebook),
]

if __name__ == "__main__":
    call_command("migrate", verbosity=0)
    course()
    server = ThreadedWSGIServer(("127.0.0.1", PORT), QuietHandler)
    server.set_app(get_wsgi_application())
    print("ready", flush=True)
    server.serve_forever()

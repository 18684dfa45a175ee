"""All addresses of the program and a few more, through which the tests reach what every view shares."""

from django.urls import path
from rest_framework.request import Request
from rest_framework.response import Response
from rest_framework.views import APIView

from config.urls import handler400, handler403, handler404, handler500
from config.urls import urlpatterns as program
from workspace.api.idempotency import idempotent
from workspace.models import Organisation

__all__ = ["handler400", "handler403", "handler404", "handler500", "urlpatterns"]


class Echo(APIView):
    """Answers what it was sent."""

    throttle_scope = "plans"

    def post(self, request: Request) -> Response:
        return Response(request.data)


class Create(APIView):
    """Makes an organisation; the body may ask for a failure afterwards."""

    @idempotent
    def post(self, request: Request) -> Response:
        organisation = Organisation.objects.create(name=request.data["name"])
        if request.data.get("fail") == "raise":
            raise ZeroDivisionError
        if request.data.get("fail") == "return":
            return Response({"error": {}}, status=409)
        return Response({"id": organisation.pk}, status=201, headers={"Location": f"/organisations/{organisation.pk}"})


urlpatterns = [*program, path("api/v1/echo", Echo.as_view()), path("api/v1/create", Create.as_view())]
